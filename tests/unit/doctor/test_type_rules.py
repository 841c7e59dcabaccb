"""The rules of wtf about types: mismatches, versions, and data that is not an LCM message."""

import pytest
from fixtures.judging import JOINTS, ODOMETRY, STRING, TWIST, findings, judge, node, pub, sub

from lcmtools.doctor.evidence import Evidence, Stream
from lcmtools.doctor.findings import Severity
from lcmtools.graph.model import Endpoint, Graph, Role, Traffic
from lcmtools.messages.registry import fingerprint, message_class
from lcmtools.wire.packet import Sender


def test_different_types_on_one_topic_are_an_error_that_names_both():
    finding = findings(
        node("/talker", pub("/chatter", STRING)), node("/listener", sub("/chatter", TWIST))
    )["type-mismatch"]
    assert finding.severity is Severity.ERROR
    assert finding.items == (
        " * /talker publishes std_msgs/String",
        " * /listener expects geometry_msgs/Twist",
    )


def test_types_of_equal_fields_do_match_but_for_a_note():
    found = findings(
        node("/a", pub("/p", "geometry_msgs/Point")), node("/b", sub("/p", "geometry_msgs/Vector3"))
    )
    assert found["type-mismatch"].severity is Severity.NOTE


def test_two_publishers_of_types_that_a_subscriber_takes_both_do_match():
    found = findings(
        node("/a", pub("/cmd", TWIST)),
        node("/b", pub("/cmd", JOINTS)),
        node("/c", sub("/cmd", JOINTS, TWIST)),
    )
    assert "type-mismatch" not in found


def test_two_publishers_of_different_types_are_at_odds():
    found = findings(node("/a", pub("/cmd", TWIST)), node("/b", pub("/cmd", JOINTS)))
    assert "type-mismatch" in found


def test_a_plain_program_that_sends_another_type_is_named_by_its_sender():
    wrong = Traffic(
        "/chatter",
        Sender("127.0.0.1", 40001),
        (fingerprint(message_class(TWIST)),),
        1,
        56,
        0,
        0,
    )
    finding = findings(node("/listener", sub("/chatter", STRING)), traffic=[wrong])["type-mismatch"]
    assert (
        finding.items[-1] == " * 127.0.0.1:40001 sends geometry_msgs/Twist or geometry_msgs/Accel"
    )


def test_of_zeros_nothing_is_said():
    raw = Traffic("EXAMPLE", Sender("127.0.0.1", 40001), (0,), 100, 800, 0, 0)
    assert findings(traffic=[raw]) == {}


@pytest.mark.parametrize(
    ("fingerprints", "likely", "said"),
    [
        ((0x1021324354657687, 0x2132435465768710), "", "data that is not an LCM message"),
        ((), "JSON", "JSON"),
        ((5,), "text", "text"),
    ],
)
def test_data_that_is_no_lcm_message_is_a_note(fingerprints, likely, said):
    sender = Sender("127.0.0.1", 40001)
    raw = Traffic("EXAMPLE", sender, fingerprints, 100, 800, 0, 0)
    streams = (Stream("EXAMPLE", sender, "x", (1,), format=likely),)
    (finding,) = judge(Evidence("udpm://x", graph=Graph((), (raw,)), streams=streams))
    assert (finding.rule, finding.severity) == ("unknown-type", Severity.NOTE)
    assert finding.text == "The following are not LCM messages:"
    assert finding.items == (f" * 'EXAMPLE' from 127.0.0.1:40001: {said}",)
    assert finding.remedies


def test_data_that_is_no_lcm_message_is_a_mismatch_for_who_expects_one():
    raw = Traffic("/chatter", Sender("127.0.0.1", 40001), (1, 2, 3, 4), 100, 800, 0, 0)
    finding = findings(node("/listener", sub("/chatter", STRING)), traffic=[raw])["type-mismatch"]
    assert finding.items[-1] == " * 127.0.0.1:40001 sends data that is not an LCM message"


def older_odometry():
    """The fingerprint of nav_msgs/Odometry without its child_frame_id."""
    from lcmtools.messages.fields import fields
    from lcmtools.messages.type_versions import fingerprint_of

    parts = fields(message_class(ODOMETRY))
    return fingerprint_of(tuple(field for field in parts if field.name != "child_frame_id"))


def test_a_mismatch_with_an_older_type_tells_the_field_that_differs():
    seen = Traffic("/odom", Sender("10.0.0.1", 4000), (older_odometry(),), 5, 500, 0, 1)
    listener = node("/listener", sub("/odom", ODOMETRY))
    finding = findings(listener, traffic=[seen])["type-mismatch"]
    assert "but without the field child_frame_id" in finding.items[1]


def test_types_of_which_nothing_is_known_are_a_note_with_what_to_do():
    seen = Traffic("OWN", Sender("10.0.0.1", 4000), (0x1021324354657687,), 5, 500, 0, 1)
    finding = findings(traffic=[seen])["unknown-type"]
    assert finding.severity is Severity.NOTE
    assert finding.items == (" * 'OWN' from 10.0.0.1:4000: an unknown type (0x1021324354657687)",)
    assert finding.remedies == (
        "name the folder of their .lcm files: export LCMTOOLS_TYPE_PATH=FOLDER",
    )


def test_an_unknown_type_that_a_node_announces_has_its_name():
    state = Endpoint("/state", Role.PUBLISHER, ("my_msgs/State",), (0x1021324354657687,))
    sender = Sender("10.0.0.1", 4000)
    seen = Traffic("/state", sender, state.fingerprints, 5, 500, 0, 1)
    finding = findings(node("/n", state)._replace(sender=sender), traffic=[seen])["unknown-type"]
    assert finding.items == (" * /state from 10.0.0.1:4000: my_msgs/State (0x1021324354657687)",)


@pytest.mark.parametrize(
    ("ends", "odd", "remedy"),
    [
        (
            (pub("/t", STRING), sub("/t", STRING), sub("/t", TWIST)),
            "/n2: /n0 and /n1 use std_msgs/String",
            "let /n2 subscribe to /t as std_msgs/String",
        ),
        (
            (pub("/t", TWIST), pub("/t", STRING), sub("/t", STRING)),
            "/n0: /n1 and /n2 use std_msgs/String",
            "let /n0 publish /t as std_msgs/String",
        ),
    ],
)
def test_a_mismatch_says_which_side_is_odd(ends, odd, remedy):
    finding = findings(*(node(f"/n{number}", end) for number, end in enumerate(ends)))[
        "type-mismatch"
    ]
    assert finding.items[-1] == f" * the odd one is {odd}"
    assert finding.remedies[0] == remedy


def test_a_node_with_several_subscriptions_to_a_topic_is_named_once():
    listener = node("/listener", *[sub("/t", TWIST)] * 3)
    finding = findings(node("/a", pub("/t", STRING)), listener)["type-mismatch"]
    assert finding.items == (
        " * /a publishes std_msgs/String",
        " * /listener expects geometry_msgs/Twist",
    )


def test_of_a_command_and_a_node_the_command_is_odd():
    command = node("/_lcmtools_pub_1", pub("/t", STRING), tool=True)
    finding = findings(command, node("/driver", sub("/t", TWIST)))["type-mismatch"]
    assert finding.items[-1] == (
        " * the odd one is /_lcmtools_pub_1: /driver uses geometry_msgs/Twist"
    )


def test_one_against_one_neither_is_odd():
    finding = findings(node("/a", pub("/t", STRING)), node("/b", sub("/t", TWIST)))["type-mismatch"]
    assert finding.items == (
        " * /a publishes std_msgs/String",
        " * /b expects geometry_msgs/Twist",
    )
    assert finding.remedies == ("remap one of them to another topic, for example /t:=/t_2",)


def test_versions_of_one_type_name_the_field_and_the_older_side():
    older = Endpoint("/odom", Role.PUBLISHER, (ODOMETRY,), (older_odometry(),))
    finding = findings(node("/old", older), node("/ear", sub("/odom", ODOMETRY)))["type-mismatch"]
    assert finding.items[0].endswith("but without the field child_frame_id)")
    assert finding.items[-1] == " * the older version is probably that of /old"
    assert finding.remedies == (
        "generate the code of both sides from the same .lcm files: lcm-gen",
    )


@pytest.mark.parametrize("numbers", [(), (1,), (1, 2)], ids=len)
def test_a_publisher_that_announces_no_fingerprint_is_judged_by_its_messages(numbers):
    sender = Sender("127.0.0.1", 40001)
    kinds = [fingerprint(message_class(name)) for name in (TWIST, JOINTS)]
    seen = [Traffic("/it", sender, (kinds[number - 1],), 5, 50, 0, number) for number in numbers]
    untyped = Endpoint("/it", Role.PUBLISHER, (STRING,))
    publisher = node("/both", untyped)._replace(sender=sender)
    found = findings(publisher, traffic=seen)
    assert ("type-mismatch" in found) == (len(numbers) > 1)
    if numbers:
        found = findings(publisher, node("/ear", sub("/it", STRING)), traffic=seen)
        items = found["type-mismatch"].items
        assert " * 127.0.0.1:40001 sends geometry_msgs/Twist or geometry_msgs/Accel" in items
        assert " * /ear expects std_msgs/String" in items
