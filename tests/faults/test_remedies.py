"""Each remedy is done: it is typed, or written into the program, and wtf finds the fault gone.

``OBEYED`` are those that ``world.obey`` does by itself, from ``wtf --json``. For ``EDITED`` one
is planted with the fault and, as the sentence says, without. The last test holds that no remedy is
left out.
"""

import signal
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from lcmtools.doctor.rules import RULES

_HERE = Path(__file__).parent
_NODE = """
import math, time, lcmtools
from lcmtools.types.geometry_msgs import *
from lcmtools.types.std_msgs import *
lcmtools.init()
node = lcmtools.Node("it")
count = 0
def every(number, seconds):
    global count
    count += 1
    if count % number == 0:
        time.sleep(seconds)
LINE
lcmtools.spin(node)
"""
_STRINGS = "m = String(); m.data = 'x'; bus.publish('/chatter', m.encode())"
_COUNTS = "m = String(); m.data = str(number %% 30); bus.publish('%s', m.encode())"
_CLOCK = (
    "m = Clock(); m.clock.sec, m.clock.nsec = divmod(20_000_000 * (%s), 10**9);"
    " bus.publish('/clock', m.encode())"
)
_FRAMES = """
from lcmtools.types.tf2_msgs import TFMessage
m = TFMessage()
for parent, child in (%s):
    transform = TransformStamped()
    transform.header.frame_id, transform.child_frame_id = parent, child
    transform.transform.rotation.w = 1.0
    m.transforms.append(transform)
m.transforms_length = len(m.transforms)
bus.publish('/tf', m.encode())
"""
_TWISTS = "bus.publish('/cmd_vel', Twist().encode())"


@dataclass(frozen=True)
class Edit:
    """A remedy that a person writes into a program: a line with the fault, and without."""

    kind: str
    rule: str
    wrong: str
    right: str
    beside: tuple[Callable[[Any], object], ...] = ()
    is_node: bool = False  # else a plain LCM program
    period: float = 0.02  # [s]
    wait: str = "1s"
    names: str = ""  # in the finding, if not the program

    def start(self, world, line):
        """Start the program with this line in it."""
        if not self.is_node:
            return world.sends(line, self.period)
        program = world.script(_NODE.replace("LINE", line))
        world.until(lambda: program.pid in world.pids())
        return program


def _hears(*channels):
    return lambda world: world.hears(*channels)


def _sends(statements, period=0.02):
    return lambda world: world.sends(statements, period)


def _runs(*words):
    return lambda world: world.node(*words)


def _ear(callback, depth=10):
    return f"node.create_subscription(String, '/chatter', lambda _: {callback}, {depth})"


def _stamped(line):
    return f"m = Imu(); m.orientation.w = 1.0; {line}; bus.publish('IMU', m.encode())"


_BURSTS = "[bus.publish('/chatter', String().encode()) for _ in range(300)]"
_NOW = "m.header.stamp.sec, m.header.stamp.nsec = divmod(time.time_ns(), 10**9)"
_SPINS = f"{_ear('None')}\ntime.sleep(%s)"
EDITED = (
    Edit("callback-less", "slow-callbacks", _ear("time.sleep(0.05)", 5000), _ear("None", 5000),
         (_sends(_STRINGS),), is_node=True),
    Edit("callback-less-or-rate", "queue-drops", _ear("time.sleep(0.05)"), _ear("None"),
         (_sends(_STRINGS),), is_node=True),
    Edit("never-wait-or-depth", "queue-drops", _ear("every(40, 0.4)"), _ear("every(40, 0.4)", 100),
         (_sends(_STRINGS),), is_node=True, wait="1.5s"),
    Edit("depth", "queue-drops", _ear("None", 3), _ear("None", 1000), (_sends(_BURSTS, 1.0),),
         is_node=True, wait="2.2s"),
    Edit("loop-waits", "queue-drops", f"for _ in range(1000): {_STRINGS}", _STRINGS,
         (lambda world: Edit("", "", "", "", is_node=True).start(world, _ear("None")),),
         names="/it"),
    Edit("spin", "queue-drops", _SPINS % 1000, _SPINS % 0, (_sends(_STRINGS),), is_node=True),
    Edit("busiest-less", "slow-callbacks",
         f"{_ear('None', 1)}\nnode.create_timer(0.02, lambda: time.sleep(0.1))",
         f"{_ear('None', 1)}\nnode.create_timer(0.02, lambda: None)",
         (_sends(_STRINGS),), is_node=True),
    Edit("read-log", "logged",
         f"{_ear('None')}\nnode.create_timer(0.2, lambda: node.get_logger().warning('low'))",
         f"{_ear('None')}\nnode.create_timer(0.2, lambda: None)", (_sends(_STRINGS),),
         is_node=True),
    Edit("correct", "callback-errors", _ear("_.text"), _ear("_.data"), (_sends(_STRINGS),),
         is_node=True),
    Edit("encode-by-lcm", "unknown-type", "bus.publish('A', b'{\"speed\": %d}' % number)",
         "bus.publish('A', Twist().encode())", (_hears("A"),)),
    Edit("plain-name", "names", "bus.publish('/map[0]', String().encode())",
         "bus.publish('/map_0', String().encode())", (_hears("/map.*"),)),
    Edit("shorter-name", "names", "bus.publish('/' + 60 * 'a', String().encode())",
         "bus.publish('/' + 20 * 'a', String().encode())", (_hears("/a*"),)),
    Edit("same-name", "names", f"{_TWISTS}; bus.publish('/Cmd_vel', Twist().encode())", _TWISTS,
         (_hears("/cmd_vel"),)),
    Edit("print-values", "not-finite", "m = Twist(); m.linear.x = math.inf; "
         "bus.publish('/cmd_vel', m.encode())", _TWISTS, (_hears("/cmd_vel"),)),
    Edit("normalise", "quaternions", "bus.publish('A', Pose().encode())",
         "m = Pose(); m.orientation.w = 1.0; bus.publish('A', m.encode())", (_hears("A"),)),
    Edit("symmetric", "covariances", _stamped(f"{_NOW}; m.angular_velocity_covariance[1] = 1.0"),
         _stamped(f"{_NOW}; m.angular_velocity_covariance[1] = 1.0; "
                  "m.angular_velocity_covariance[3] = 1.0"), (_hears("IMU"),)),
    Edit("unknown-covariance", "covariances",
         _stamped(f"{_NOW}; m.angular_velocity_covariance[1] = 1.0"),
         _stamped(f"{_NOW}; m.angular_velocity_covariance[1] = 1.0; "
                  "m.angular_velocity_covariance[0] = -1.0"), (_hears("IMU"),)),
    Edit("stamp-if-no-log", "stamps", _stamped(f"{_NOW}; m.header.stamp.sec -= 60"),
         _stamped(_NOW), (_hears("IMU"),)),
    Edit("split-time", "stamps", _stamped("m.header.stamp.sec = int(time.time()); "
                                          "m.header.stamp.nsec = 2 * 10**9"),
         _stamped(_NOW), (_hears("IMU"),)),
    Edit("stamp-utc", "stamps", _stamped("m.header.stamp.sec = int(time.monotonic())"),
         _stamped(_NOW), (_hears("IMU"),)),
    Edit("one-parent", "frames", _FRAMES % "('odom', 'base'), ('map', 'base')",
         _FRAMES % "('odom', 'base'), ('map', 'odom')", (_hears("/tf"),)),
    Edit("exchange-frames", "frames", _FRAMES % "('odom', 'base'), ('base', 'odom')",
         _FRAMES % "('odom', 'base'),", (_hears("/tf"),)),
    Edit("time-rises", "slow-simulator", _CLOCK % "number % 10", _CLOCK % "number",
         (_hears("/clock"),)),
    Edit("use-lcm-gen", "undecodable", "bus.publish('A', Twist().encode()[:-3])",
         "bus.publish('A', Twist().encode())", (_hears("A"),)),
    Edit("sends-as", "type-mismatch", "bus.publish('/chatter', Twist().encode())", _STRINGS,
         (_runs("listener"), _runs("listener", "__name:=second"))),
    Edit("rename-one", "type-mismatch", "bus.publish('A', Twist().encode())",
         "bus.publish('B', Twist().encode())",
         (_hears("A", "B"), _sends("bus.publish('A', String().encode())"))),
    Edit("open-circle", "competing-publishers", _COUNTS % "A", _COUNTS % "B",
         (_hears("A", "B"), _sends(_COUNTS % "A"))),
    Edit("publishes-as", "type-mismatch",
         "p = node.create_publisher(Twist, '/chatter')\n"
         "node.create_timer(0.1, lambda: p.publish(Twist()))",
         "p = node.create_publisher(String, '/chatter')\n"
         "node.create_timer(0.1, lambda: p.publish(String()))",
         (_runs("listener"), _runs("listener", "__name:=second")), is_node=True),
    Edit("expects-as", "type-mismatch", _ear("None").replace("String", "Twist"), _ear("None"),
         (_runs("talker"), _runs("listener")), is_node=True),
    Edit("same-type", "type-mismatch",
         _ear("None").replace("String, '/chatter", "Accel, '/cmd_vel"),
         _ear("None").replace("String, '/chatter", "Twist, '/cmd_vel"),
         (lambda world: world.tool("pub", "-r", "10", "/cmd_vel", "geometry_msgs/Twist", "{}"),),
         is_node=True),
    Edit("change-type", "unconnected-subscriptions",
         _ear("None").replace("String, '/chatter", "Twist, '/chater"), _ear("None"),
         (_sends(_STRINGS), _runs("listener")), is_node=True),
)  # fmt: skip


@pytest.mark.parametrize("edit", EDITED, ids=lambda edit: edit.kind)
def test_a_remedy_is_written_into_the_program(world, edit):
    for start in edit.beside:
        start(world)
    program = edit.start(world, edit.wrong)
    name = edit.names or ("/it" if edit.is_node else program.pid)
    found = world.finds(edit.rule, name, wait=edit.wait)
    assert edit.kind in found.kinds
    world.end(program)
    edit.start(world, edit.right)
    world.is_silent(wait=edit.wait)


def _stopped(world):
    world.node("listener")
    world.node("talker").send_signal(signal.SIGSTOP)


def _killed(world):
    world.node("talker")
    world.node("listener")
    killed = world.node("listener", "__name:=second")
    killed.send_signal(signal.SIGKILL)
    killed.wait()


def _frozen_sender(world):
    world.hears("A")
    world.node("talker")
    world.node("listener")
    world.sends("bus.publish('A', Twist().encode())").send_signal(signal.SIGSTOP)


def _last_tick(world):
    ends = [end for node in world.graph().nodes for end in node.endpoints]
    return max((end.last_time for end in ends if end.topic == "/clock"), default=0)


def _paused(world):
    world.node("sim", "--world", "empty")
    world.type("lcmtools sim pause")
    world.until(lambda: time.time_ns() - _last_tick(world) > 1.1e9)


def _driven_on(world):
    world.node("sim", "--world", "husky")
    world.type("lcmtools pub -1 -w 1 /husky0/cmd_vel geometry_msgs/Twist 'linear: {x: 0.5}'")


def _plugged_out(world):
    for command in (
        "ip link add lan0 type veth peer name peer0",
        "ip link set peer0 up",
        "ip addr add 10.77.0.1/24 dev lan0",
        "ip link set lan0 up multicast on",
        "ip route replace 224.0.0.0/4 dev lan0",
    ):
        world.type(command)
    listener = world.lcm("lcm-sink")
    world.node("talker")
    world.node("listener")
    world.type("ip route replace 224.0.0.0/4 dev lo")
    assert listener.pid


def _planted(*starts):
    def plant(world):
        for start in starts:
            start(world)

    return plant


def _away(world):
    url = "udpm://239.255.76.67:7670?ttl=0"
    world.hears("A", LCM_DEFAULT_URL=url)


_PAIR = (_runs("talker"), _runs("listener"))
OBEYED = (
    ("wake-or-end", "stale-nodes", _stopped),
    ("wake-or-end", "silent", _frozen_sender),
    ("resume", "slow-simulator", _paused),
    ("restart-or-forget", "stale-nodes", _killed),
    ("end-or-rename", "duplicate-names", _planted(*_PAIR, _runs("listener"))),
    ("end-or-part", "duplicate-names", _planted(
        lambda world: world.tool("pub", "-r", "5", "/RosAria/cmd_vel", "geometry_msgs/Twist", "{}"),
        *2 * [_runs("sim", "--world", "pioneer")])),
    ("drop-remap", "no-clock", _planted(_runs("talker", "_use_sim_time:=true"), _runs("listener"))),
    ("start-simulator", "no-clock", _planted(_runs("talker", "_use_sim_time:=true"))),
    ("start-something", "no-traffic", lambda _: None),
    ("send-zeros", "driven-by-nobody", _driven_on),
    ("end-one-or-remap", "competing-publishers", _planted(*_PAIR, _runs("talker", "__name:=b"))),
    ("end-one-or-part", "competing-publishers", _planted(
        lambda world: world.tool("pub", "-r", "5", "/RosAria/cmd_vel", "geometry_msgs/Twist", "{}"),
        *(_runs("sim", "--world", "pioneer", f"__name:={name}") for name in "ab"))),
    ("end-one-or-rename", "competing-publishers",
     _planted(_hears("A"), *2 * [_sends("bus.publish('A', Twist().encode())")])),
    ("namespace", "unconnected-subscriptions",
     _planted(_runs("talker", "__ns:=/a"), _runs("listener"))),
    ("drop-remap", "unconnected-subscriptions",
     _planted(_runs("talker", "chatter:=/chater"), _runs("listener"))),
    ("replace-remap", "unconnected-subscriptions",
     _planted(_runs("talker", "__ns:=/a"), _runs("listener", "chatter:=/a/chattr"))),
    ("remap", "unconnected-subscriptions",
     _planted(_sends("bus.publish('/chater', String().encode())"), _runs("listener"))),
    ("republish", "unconnected-subscriptions", _planted(_runs("listener"), lambda world: world.tool(
        "pub", "-r", "5", "/chater", "std_msgs/String", "data: hi"))),
    ("join-here", "other-buses", _planted(*_PAIR, _away)),
    ("restart-listeners", "interfaces", _plugged_out),
)  # fmt: skip


@pytest.mark.parametrize(("kind", "rule", "plant"), OBEYED, ids=[f"{k} {r}" for k, r, _ in OBEYED])
def test_a_remedy_is_done_as_it_stands(world, kind, rule, plant):
    plant(world)
    found = next(one for one in world.look(wait="1s") if one.rule == rule)
    world.obey(found, kind)
    if kind.startswith(("start-", "send-")):  # what runs may lack something else
        assert world.look("--rule", rule) == []
    else:
        world.is_silent(wait="1s")


def test_a_link_is_connected_or_the_route_led_elsewhere(world):
    for number in (0, 1):
        world.type(f"ip link add lan{number} type veth peer name peer{number}")
        world.type(f"ip addr add 10.{77 + number}.0.1/24 dev lan{number}")
        world.type(f"ip link set lan{number} up multicast on")
    world.type("ip link set peer1 up")
    world.type("ip route replace 224.0.0.0/4 dev lan0")
    variable = {"LCM_DEFAULT_URL": "udpm://239.255.76.67:7667?ttl=1"}
    found = next(one for one in world.look(**variable) if one.rule == "link")
    assert found.kinds == ["connect", "route-to"]
    world.type("ip link set peer0 up")  # the other end, as a cable that is plugged in
    assert world.look("--rule", "link", **variable) == []
    world.type("ip link set peer0 down")
    world.obey(found, "route-to")
    assert world.look("--rule", "link", **variable) == []


def test_the_folder_of_types_is_named(world, tmp_path):
    definition = "package own; struct State { int16_t wheels[4]; }"
    world.hears("STATE")
    world.c("sends", "STATE", world.fingerprint(definition), "16", "20")
    found = world.finds("unknown-type")
    assert found.kinds == ["type-path"]
    (tmp_path / "types").mkdir()
    (tmp_path / "types/State.lcm").write_text(definition.replace(";", ""))
    types = {"LCMTOOLS_TYPE_PATH": str(tmp_path / "types")}
    found = world.finds("unknown-type", "State.lcm:1: ", **types)
    assert found.kinds == ["correct-file", "type-path"]
    (tmp_path / "types/State.lcm").write_text(definition)
    world.is_silent(**types)


def test_a_utime_is_sent_in_microseconds(world, tmp_path):
    definition = "package own; struct Pose { int64_t utime; double x; }"
    (tmp_path / "Pose.lcm").write_text(definition)
    head = f"bytes.fromhex('{int(world.fingerprint(definition), 16):016x}')"
    line = f"import struct; bus.publish('POSE', {head} + struct.pack('>qd', %s, 1.0))"
    world.hears("POSE")
    program = world.sends(line % "time.time_ns()")
    found = world.finds("stamps", program.pid, LCMTOOLS_TYPE_PATH=str(tmp_path))
    assert "microseconds" in found.kinds
    world.end(program)
    world.sends(line % "time.time_ns() // 1000")
    world.is_silent(LCMTOOLS_TYPE_PATH=str(tmp_path))


def test_a_variable_is_corrected(world):
    world.node("talker")
    world.node("listener")
    found = world.finds("environment", LCMTOOLS_TYPE_PATH="/nonexistent")
    assert found.kinds == ["correct-environment"]
    world.is_silent()


def test_a_bus_in_the_code_is_left_out(world):
    code = "import lcm, time\nbus = lcm.LCM({})\nprint('runs', flush=True)\n"
    code += "while True:\n    bus.publish('A', b'')\n    time.sleep(0.05)\n"
    world.node("talker")
    world.node("listener")
    away = world.script(code.format("'udpm://239.255.76.67:7670?ttl=0'"), ready="runs")
    found = world.finds("other-buses", away.pid, "on-bus-by-code", "239.255.76.67:7670")
    assert found.kinds == ["join-here", "name-here"]
    world.end(away)
    world.script(code.format(""), ready="runs")
    world.is_silent()


def test_of_two_types_one_moves_to_another_topic(world):
    line = "p = node.create_publisher(Twist, '/chatter')\n"
    line += "node.create_timer(0.1, lambda: p.publish(Twist()))"
    world.node("listener")
    program = world.script(_NODE.replace("LINE", line))
    world.until(lambda: program.pid in world.pids())
    found = world.finds("type-mismatch")
    assert found.kinds == ["remap-one"]
    world.again(program, "/chatter:=/chatter_2")
    assert world.look("--rule", "type-mismatch") == []


def test_a_slash_is_removed(world):
    world.node("talker", "__ns:=/a")
    program = world.script(_NODE.replace("LINE", _ear("None")), "__ns:=/a")
    world.until(lambda: program.pid in world.pids())
    found = world.finds("unconnected-subscriptions", "/a/it")
    assert found.kinds == ["remove-slash"]
    world.end(program)
    line = _ear("None").replace("'/chatter'", "'chatter'")
    program = world.script(_NODE.replace("LINE", line), "__ns:=/a")
    world.until(lambda: program.pid in world.pids())
    world.is_silent()


def test_a_slash_that_keeps_a_remap_from_being_applied_is_removed(world):
    world.node("talker", "__ns:=/a")
    arguments = ("__ns:=/a", "heard:=chatter")
    line = _ear("None").replace("'/chatter'", "'/heard'")
    program = world.script(_NODE.replace("LINE", line), *arguments)
    world.until(lambda: program.pid in world.pids())
    found = world.finds("unconnected-subscriptions", "heard:=chatter")
    assert found.kinds == ["remove-slash-of-remap"]
    world.end(program)
    program = world.script(_NODE.replace("LINE", line.replace("/heard", "heard")), *arguments)
    world.until(lambda: program.pid in world.pids())
    world.is_silent()


@pytest.mark.parametrize(
    ("channel", "wrong", "kind", "right"),
    [
        ("POSE", "'POSE', {}, 10", "plain-channel", "'POSE', {}, 10, plain_channel=True"),
        ("/pose", "'pose', {}, 10, plain_channel=True", "subscribe", "'/pose', {}, 10"),
    ],
)
def test_a_node_receives_from_a_plain_channel_or_a_topic(world, channel, wrong, kind, right):
    _sends(f"bus.publish('{channel}', String().encode())")(world)

    def starts(arguments):
        line = f"node.create_subscription(String, {arguments.format('lambda _: None')})"
        program = world.script(_NODE.replace("LINE", line))
        world.until(lambda: program.pid in world.pids())
        return program

    program = starts(wrong)
    assert world.finds("unconnected-subscriptions", channel.strip("/")).kinds == [kind]
    world.end(program)
    starts(right)
    world.is_silent()


ELSEWHERE = {  # the tests that do them
    "allow-command": "test_a_command_that_a_relay_does_not_let_pass",
    "carry-less": "test_a_relay_that_drops_what_its_line_does_not_take",
    "close-files": "test_a_program_with_nearly_all_files_open",
    "connect": "test_a_link_is_connected_or_the_route_led_elsewhere",
    "correct-file": "test_the_folder_of_types_is_named",
    "correct-environment": "test_a_variable_is_corrected",
    "end-standby": "test_a_relay_beside_another_one",
    "export": "test_a_program_on_another_bus",
    "fix-log": "test_the_damaged_bytes_of_a_log_are_left_out",
    "mend-bus": "test_a_bus_without_a_route",
    "limit-rates": "test_wtf_names_a_full_line_on_both_sides_and_the_rate_that_it_takes",
    "limit-sender": "test_wtf_names_a_full_line_on_both_sides_and_the_rate_that_it_takes",
    "microseconds": "test_a_utime_is_sent_in_microseconds",
    "mend-line": "test_a_relay_whose_server_has_ended",
    "name-here": "test_a_bus_in_the_code_is_left_out",
    "plain-channel": "test_a_node_receives_from_a_plain_channel_or_a_topic",
    "publish-less": "test_wtf_names_a_line_that_a_node_fills_on_both_sides",
    "publish-smaller": "test_wtf_names_a_line_that_a_node_fills_on_both_sides",
    "own-domain": "test_another_user_on_the_same_bus",
    "remap-one": "test_of_two_types_one_moves_to_another_topic",
    "remove-slash": "test_a_slash_is_removed",
    "remove-slash-of-remap": "test_a_slash_that_keeps_a_remap_from_being_applied_is_removed",
    "route": "test_a_route_that_does_not_leave_the_computer",
    "route-to": "test_a_link_is_connected_or_the_route_led_elsewhere",
    "same-lcm-files": "test_an_old_definition_of_a_message",
    "send-elsewhere": "test_datagrams_that_are_none_of_lcms",
    "send-smaller-on": "test_a_node_that_receives_large_messages_without_their_ends",
    "send-less": "test_a_sender_whose_messages_get_lost",
    "set-rate": "test_a_simulator_that_was_made_slow",
    "simulate-less": "test_a_simulator_that_has_too_much_to_do",
    "start-server": "test_a_service_that_no_node_offers",
    "smaller-messages": "test_datagrams_whose_pieces_do_not_all_come",
    "start-it-with-variable": "test_a_message_that_no_usual_buffer_takes",
    "subscribe": "test_a_node_receives_from_a_plain_channel_or_a_topic",
    "start-publisher": "test_a_topic_that_nothing_publishes",
    "start-with-variable": "test_a_program_of_the_other_provider",
    "sysctl": "test_a_strict_filter_of_routes",
    "ttl-1-is-enough": "test_messages_that_leave_the_network",
    "type-path": "test_the_folder_of_types_is_named",
    "use-ttl-1": "test_wtf_names_who_cannot_be_heard_by_the_others",
}
SHOW_ONLY = frozenset(  # where to look further: they change nothing
    ("compare-buses", "compare-clocks", "inspect", "inspect-java", "inspect-python")
) | {"find-second-way", "look-at-firewall", "look-there"}
NEED_MORE = {  # than a network on a Linux computer
    "allow-by-firewalld": "firewalld, and another computer",
    "allow-by-iptables": "iptables, and another computer",
    "allow-by-nftables": "nft, and another computer",
    "allow-by-ufw": "ufw, and another computer",
    "callback-less-or-depth": "a node that counts no calls",
    "enable-querier": "a bridge in /sys, which a network namespace does not show",
    "host-network": "a container",
    "larger-buffer-there": "another computer whose buffers are too small",
    "if-no-log": "a computer with a clock of its own",
    "macos-large-datagrams": "macOS",
    "mirrored-network": "Windows",
    "set-clocks": "a computer with a clock of its own",
    "subscribe-to-pattern": "nothing: the warning stays for other programs",
    "update-here": "nodes of another version of lcmtools",
    "update-there": "nodes of another version of lcmtools",
    "use-server": "a container",
    "use-sim-time": "a clock of the past",
    "use-ttl-0": "Wi-Fi",
    "zero-joints": "the names of a robot's joints",
}


def test_no_remedy_is_left_out():
    done = {edit.kind for edit in EDITED} | {kind for kind, _, _ in OBEYED} | ELSEWHERE.keys()
    assert done | SHOW_ONLY | NEED_MORE.keys() == {kind for rule in RULES for kind in rule.remedies}
    assert done.isdisjoint(SHOW_ONLY | NEED_MORE.keys())
    tests = "".join(file.read_text() for file in _HERE.parent.glob("*/test_*.py"))
    assert all(f"def {test}(" in tests for test in ELSEWHERE.values())
