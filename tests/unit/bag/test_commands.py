"""Commands among the topics that are played: who would obey, and what stands at the end."""

import pytest
from fixtures.says import assert_says

from lcmtools.bag.commands import (
    Conflict,
    LastCommands,
    conflicts,
    is_command,
    reasons,
    way_out,
)
from lcmtools.bag.playlist import Track
from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role, Staleness, Traffic
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.registry import fingerprint, message_class, type_name
from lcmtools.messages.supply import set_supply
from lcmtools.packages import provide_user_types
from lcmtools.types.geometry_msgs import Pose, Twist, TwistStamped
from lcmtools.types.sensor_msgs import JointState
from lcmtools.wire.packet import Sender

HOST = NodeInfo("/robot", "1", "elsewhere", 12)
SENDER = Sender("10.0.0.9", 4000)


def track(topic, kind=Twist):
    if kind is None:
        return Track(topic, topic, 1)
    return Track(topic, topic, 1, type_name(kind), fingerprint(kind))


def with_ends(node, *ends):
    return node._replace(endpoints=ends)


def subscriber(topic, node=HOST):
    return with_ends(node, Endpoint(topic, Role.SUBSCRIBER))


def publisher(topic, node=HOST):
    return with_ends(node, Endpoint(topic, Role.PUBLISHER))


SIMULATOR = with_ends(
    HOST, Endpoint("/a", Role.SUBSCRIBER), Endpoint("/s", Role.SERVICE, ("sim_msgs/Step",))
)


@pytest.mark.parametrize(
    ("topic", "kind", "expected"),
    [
        ("/a", Twist, True),
        ("/a", TwistStamped, True),
        ("/a", JointState, False),
        ("/husky0/wheel_cmd", JointState, True),
        ("WHEEL_COMMAND", None, True),
        ("motorEffort", None, True),
        ("/goal", Pose, True),
        ("/joint_states", JointState, False),
        ("/goals_scored", None, False),
        ("/cmd/status", None, False),
    ],
)
def test_a_command_is_told_by_its_type_or_name(
    topic,
    kind,
    expected,
):
    assert is_command(track(topic, kind)) is expected


@pytest.mark.parametrize(
    ("node", "reason"),
    [
        (publisher("/a"), "/a is published by /robot (elsewhere, pid 12)"),
        (subscriber("/a"), "/a commands /robot (elsewhere, pid 12)"),
        (SIMULATOR, "/a commands /robot (elsewhere, pid 12)"),
        (subscriber("/b"), None),
        (publisher("/a")._replace(stale=Staleness.SILENT), None),
        (subscriber("/a")._replace(stale=Staleness.SILENT), None),
        (subscriber("/a")._replace(tool=True), None),
    ],
)
def test_reasons_not_to_play(node, reason):
    tracks = [track("/a"), track("/c", JointState)]
    found = conflicts(Graph((node,)), tracks)
    assert [one.reason for one in found] == ([reason] if reason else [])
    assert way_out(found, tracks) == ("-x /a" if reason else "")


def test_the_remedy_for_a_channel_that_is_no_name_can_be_typed():
    tracks = [track("a b"), track("/c")]
    found = conflicts(Graph((publisher("a b"),)), tracks)
    assert way_out(found, tracks) == "-x 'a b'"
    assert way_out(found, tracks[:1]) == "--ns /replay", "else nothing would be left"


def test_a_busy_bus_is_refused_in_three_lines():
    names = [f"/{letter}" for letter in "abcdef"]
    found = [Conflict(name, name, "/sim (vm, pid 1)", obeys=False) for name in names]
    found.append(Conflict("/cmd_vel", "/cmd_vel", "/sim (vm, pid 1)", obeys=True))
    said = [
        "/sim (vm, pid 1) would obey /cmd_vel",
        "/sim (vm, pid 1) publishes /a, /b, /c and 3 more",
    ]
    assert reasons(found) == said
    found += [Conflict("/a", "/a", f"/other{n} (vm, pid 2)", obeys=False) for n in range(2)]
    assert reasons(found) == [*said, "other programs use topics of the log, too"]
    assert way_out(found, [track(name) for name in (*names, "/cmd_vel", "/x")]) == "--ns /replay"
    assert reasons([]) == []


def test_a_simulator_obeys_whatever_it_subscribes_to():
    assert len(conflicts(Graph((SIMULATOR,)), [track("/a", JointState)])) == 1
    assert conflicts(Graph((subscriber("/a"),)), [track("/a", JointState)]) == []


def test_a_program_that_is_no_node_publishes_too():
    seen = Traffic("/a", SENDER, (), 1, 8, 0, 0)
    found = conflicts(Graph((), (seen,)), [track("/a")])
    (conflict,) = found
    assert_says(conflict.reason, "/a", "published", "10.0.0.9", "4000")


def test_the_players_own_messages_do_not_count():
    own = publisher("/a")._replace(name="/player", sender=SENDER)
    seen = Traffic("/a", SENDER, (), 1, 8, 0, 0)
    assert conflicts(Graph((own,), (seen,)), [track("/a")], own="/player") == []
    assert len(conflicts(Graph((own,), (seen,)), [track("/a")])) == 1


def test_all_nodes_may_share_rosout():
    assert conflicts(Graph((publisher("/rosout"),)), [track("/rosout", None)]) == []


def twist(forward):
    message = Twist()
    message.linear.x = forward
    return encode(message)


def test_the_last_command_stands_until_it_is_zero():
    commands = LastCommands([track("/a"), track("/b")])
    graph = Graph((subscriber("/a"),))
    commands.add("/a", twist(1.0))
    commands.add("/a", twist(0.5))
    commands.add("/b", twist(0.5))
    (one,) = commands.pop(graph, heard=False)
    assert one[:2] == ("/a", "linear.x 0.5")
    assert one.stop == twist(0.0)
    assert one.typed == "lcmtools pub -1 /a geometry_msgs/Twist '{}'"
    assert commands.pop(graph, heard=False) == []
    commands.add("/a", twist(0.0))
    assert commands.pop(graph, heard=False) == []


def test_programs_that_are_no_nodes_may_obey_what_is_a_command():
    commands = LastCommands([track("/b"), track("/c", JointState)])
    state = JointState()
    state.effort, state.name = [1.0], ["wheel"]
    commands.add("/b", twist(0.5))
    commands.add("/c", encode(state))
    assert [one.topic for one in commands.pop(Graph(), heard=True)] == ["/b"]


def test_efforts_are_stopped_by_zeros_for_the_same_joints():
    commands = LastCommands([track("/wheel_cmd", JointState)])
    state = JointState()
    state.header.seq, state.effort, state.name = 7, [1.0, -1.0], ["left", "right"]
    commands.add("/wheel_cmd", encode(state))
    (one,) = commands.pop(Graph((subscriber("/wheel_cmd"),)), heard=False)
    assert one.values == "effort0 1, effort1 -1"
    assert one.stop is not None
    stop = decode(JointState, one.stop)
    assert (stop.header.seq, stop.effort, stop.name) == (7, (0.0, 0.0), ["left", "right"])
    assert one.typed.endswith("""'{"name":["left","right"],"effort":[0,0]}'""")


def test_zero_is_no_stop_for_a_position():
    commands = LastCommands([track("/arm_cmd", JointState), track("/x_cmd", None)])
    state = JointState()
    state.position = [1.5]
    commands.add("/arm_cmd", encode(state))
    commands.add("/x_cmd", b"anything")
    graph = Graph(
        (with_ends(HOST, *subscriber("/arm_cmd").endpoints, *subscriber("/x_cmd").endpoints),)
    )
    found = commands.pop(graph, heard=False)
    arm, unknown = map(tuple, found)
    assert arm == ("/arm_cmd", "position0 1.5", None, "")
    assert (unknown[0], *unknown[2:]) == ("/x_cmd", None, "")
    assert_says(unknown[1], "not known")


@pytest.mark.parametrize(
    ("field", "shown"),
    [
        ("utime", ""),
        ("timestamp", ""),
        ("t", ""),
        ("time_us", ""),
        ("last_cmd_time", ""),
        ("seq", ""),
        ("sequence_number", ""),
        ("robotId", ""),
        ("robot_id", ""),
        ("num_joints", ""),
        ("speed", "speed 2"),
        ("speed_ms", "speed_ms 2"),
        ("tilt", "tilt 2"),
        ("timed_speed", "timed_speed 2"),
        ("width", "width 2"),
    ],
)
def test_times_numbers_and_names_are_no_motion(field, shown, monkeypatch, tmp_path):
    (tmp_path / "drive_t.lcm").write_text(f"package own; struct drive_t {{ int64_t {field}; }}")
    monkeypatch.setenv("LCMTOOLS_TYPE_PATH", str(tmp_path))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    provide_user_types()
    try:
        kind = message_class("own/drive_t")
        message = kind()
        setattr(message, field, 2)
        commands = LastCommands([track("DRIVE_COMMAND", kind)])
        commands.add("DRIVE_COMMAND", encode(message))
        found = [one.values for one in commands.pop(Graph(), heard=True)]
    finally:
        set_supply(None)
    assert found == [shown][: bool(shown)]
