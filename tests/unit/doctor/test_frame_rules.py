"""Coordinate frames that form no trees."""

from fixtures.judging import judge

from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.listening import Listening
from lcmtools.doctor.rules import frames
from lcmtools.messages.codec import encode
from lcmtools.types.geometry_msgs import TransformStamped
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools.wire.packet import Packet, Sender

ALICE, BOB = (Sender("127.0.0.1", port) for port in (4000, 4001))


def heard(*sent):
    """The findings of these transforms: a sender, a topic, and "parent>child" pairs."""
    listening = Listening(lambda _: ())
    for number, (sender, topic, pairs) in enumerate(sent):
        message = TFMessage()
        for pair in pairs.split():
            transform = TransformStamped()
            transform.header.frame_id, transform.child_frame_id = pair.split(">")
            transform.transform.rotation.w = 1.0
            message.transforms.append(transform)
        listening.add_packet(Packet(topic, encode(message), 1_000_000 * number, sender, number))
    found = listening.frames({ALICE: "alice", BOB: "bob"}.__getitem__)
    findings = judge(Evidence("udpm://", frames=found), [frames.frames_are_trees])
    return [finding.items for finding in findings]


def test_a_tree_of_frames_is_no_finding():
    tree = (ALICE, "/tf", "map>odom /odom>base"), (BOB, "/tf_static", "base>/laser base>camera")
    assert heard(*tree, *tree) == []


def test_a_frame_with_two_parents_is_told_with_who_sends_them():
    sent = (ALICE, "/tf", "map>odom odom>base"), (BOB, "/tf_static", "map>base")
    assert (
        heard(*sent)
        == heard(*reversed(sent))
        == [(" * base is in map (by bob) and odom (by alice)",)]
    )
    assert heard((ALICE, "/a/tf", "odom>base"), (BOB, "/b/tf", "map>base")) == []


def test_frames_below_themselves_are_told_once_as_a_circle():
    found = heard((ALICE, "/tf", "map>odom odom>base base>camera"), (BOB, "/tf", "base>map"))
    assert found == [(" * base -> odom -> map -> base, from alice and bob",)]
    assert heard((ALICE, "/tf", "base>base")) == [(" * base -> base, from alice",)]
