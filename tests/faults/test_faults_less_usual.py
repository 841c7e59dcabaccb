"""Faults that look like others, or that one cause makes of several."""

import json
import signal
from typing import Any

import pytest

UNFED = "unconnected-subscriptions"
RAW = """
import socket, struct, sys, time
out, number = socket.socket(socket.AF_INET, socket.SOCK_DGRAM), 0
def short(channel, data):
    return b"LC02" + struct.pack(">I", number) + channel + b"\\0" + data
def part(size, offset, place, count, data):
    head = b"LC03" + struct.pack(">IIIHH", number, size, offset, place, count)
    return head + (b"BIG\\0" if place == 0 else b"") + data
while True:
    number += 1
    out.sendto(eval(sys.argv[1]), ("239.255.76.67", 7667))
    if number == 3:
        print("sends", flush=True)
    time.sleep(0.03)
"""
EAR = """
import lcmtools
from lcmtools.types.geometry_msgs import {type}
lcmtools.init()
node = lcmtools.Node("ear")
node.create_subscription({type}, "/at", lambda _: None, 10)
print("listens", flush=True)
lcmtools.spin(node)
"""
STEER = ("pub", "-r", "10", "/husky0/desired_velocity", "geometry_msgs/Twist", "{}")


def _twist(channel: str) -> str:
    return f"bus.publish('{channel}', Twist().encode())"


@pytest.mark.parametrize("channel", ["husky0/velocity_cmd", "/velocity_cmd", "velocity_cmd"])
def test_a_plain_program_that_steers_past_the_robot(world: Any, channel: str) -> None:
    world.node("sim", "--world", "husky")
    sender = world.sends(_twist(channel), 0.1)
    world.finds(
        UNFED, f"'{channel}'", f"(pid {sender.pid})", "let it publish on '/husky0/velocity_cmd'"
    )
    world.end(sender)
    world.sends(_twist("/husky0/velocity_cmd"), 0.1)
    world.is_silent()


@pytest.mark.parametrize("topic", ["/Husky0/velocity_cmd", "/velocity_cmd"])
def test_a_command_that_steers_past_the_robot(world: Any, topic: str) -> None:
    world.node("sim", "--world", "husky")
    pub = ("pub", "-r", "10", topic, "geometry_msgs/Twist", "{}", "__name:=me")
    sender = world.tool(*pub)
    world.finds(UNFED, f"publishes {topic}: let it publish on '/husky0/velocity_cmd'")
    world.end(sender)
    world.tool(*(word.replace(topic, "/husky0/velocity_cmd") for word in pub))
    world.is_silent()


def test_a_remap_that_leads_away_from_the_odometry(world: Any) -> None:
    world.node("sim", "--world", "husky")
    remaps = ("controlled_velocity:=velocity_cmd", "odometry:=odom")
    world.node("simple_controller", "__ns:=/husky0", *remaps)
    world.tool(*STEER)
    found = world.finds(UNFED, "start /husky0/simple_controller without odometry:=odom")
    assert len(found.remedies) == 1
    world.obey(found)
    world.is_silent()


def test_a_simulator_that_was_killed_is_the_only_finding(world: Any) -> None:
    sim = world.node("sim", "--world", "husky")
    world.node("simple_controller", "__ns:=/husky0", "controlled_velocity:=velocity_cmd")
    world.tool(*STEER)
    world.is_silent()
    sim.send_signal(signal.SIGKILL)
    sim.wait()
    world.finds("stale-nodes", f"/morse (pid {sim.pid})")
    world.node("sim", "--world", "husky")
    world.is_silent()


def test_a_listener_that_was_killed_is_the_only_finding(world: Any) -> None:
    world.node("talker")
    listener = world.node("listener")
    world.is_silent()
    listener.send_signal(signal.SIGKILL)
    listener.wait()
    world.finds("stale-nodes", f"/listener (pid {listener.pid})")


def test_two_plain_programs_that_send_different_types(world: Any) -> None:
    world.hears("A")
    first = world.sends(_twist("A"))
    second = world.sends("bus.publish('A', String().encode())")
    world.finds("type-mismatch", f"(pid {first.pid})", f"(pid {second.pid})", "std_msgs/String")
    world.end(second)
    world.is_silent()


def test_a_plain_program_that_is_frozen_on_an_else_quiet_bus(world: Any) -> None:
    world.hears("A")
    sender = world.sends(_twist("A"))
    sender.send_signal(signal.SIGSTOP)
    found = world.finds("silent", f"(pid {sender.pid})")
    world.type(found.commands[0])
    world.is_silent()


def test_plain_programs_that_have_nothing_to_say(world: Any) -> None:
    listener = world.hears("A")
    found = world.finds("no-traffic", f"(pid {listener.pid}) listens")
    assert found.severity == "note"


def test_large_messages_of_which_a_part_never_comes(world: Any) -> None:
    sender = world.script(RAW, "part(3000, 0, 0, 3, bytes(1000))", ready="sends")
    world.finds("loss", f"(pid {sender.pid})", "before they left it")


@pytest.mark.parametrize(
    ("datagram", "reason"),
    [
        ("b'LC'", "not with LC02 or LC03"),
        ("part(3000, 0, 9, 3, bytes(100))", "number 9 of 3"),
        ("part(3000, 2950, 0, 3, bytes(100))", "beyond the message's 3000 bytes"),
        ("part(2**32 - 1, 0, 0, 65535, bytes(100))", "message of 4294967295 bytes"),
        ("short(b'C' * 100, bytes(20))", "not ended within 63 bytes"),
    ],
)
def test_datagrams_that_are_nearly_lcms(world: Any, datagram: str, reason: str) -> None:
    world.node("talker")
    world.node("listener")
    sender = world.script(RAW, datagram, ready="sends")
    world.finds("malformed", f"(pid {sender.pid})", reason)
    world.end(sender)
    world.is_silent()


def test_a_channel_without_a_name(world: Any) -> None:
    sender = world.script(RAW, "short(b'', bytes(20))", ready="sends")
    world.finds("names", "''", f"(pid {sender.pid})")


@pytest.mark.parametrize(
    ("known", "definition", "difference"),
    [
        (
            "Pose2D",
            "struct Pose2D { double theta; double x; double y; }",
            "its fields stand in the order theta, x, y",
        ),
        (
            "Pose2D",
            "struct Pose2D { double x; double y; double theta; int8_t priority; }",
            "with priority (int8) at the end",
        ),
        (
            "Quaternion",
            "struct Quaternion { float x; float y; float z; float w; }",
            "every float64 is float32",
        ),
    ],
)
def test_more_ways_to_differ_from_a_type(
    world: Any, known: str, definition: str, difference: str
) -> None:
    world.script(EAR.format(type=known), ready="listens")
    sender = world.c("sends", "/at", world.fingerprint(f"package old; {definition}"), "40", "20")
    found = world.finds("type-mismatch", sender.pid, f"like geometry_msgs/{known}", difference)
    assert "lcm-gen" in found.remedies[0]


def test_no_number_where_a_laser_says_how_it_looks(world: Any) -> None:
    scan = "m = LaserScan(); m.angle_min = math.nan; bus.publish('L', m.encode())"
    sender = world.sends(scan)
    world.finds("not-finite", f"(pid {sender.pid})", "angle_min is nan")


def test_a_stamp_with_too_many_nanoseconds(world: Any) -> None:
    stamped = "m = PoseStamped(); m.pose.orientation.w = 1.0; t = m.header.stamp; "
    stamped += "t.sec, t.nsec = int(time.time()), 1_999_999_999; bus.publish('P', m.encode())"
    sender = world.sends(stamped)
    world.finds("stamps", f"(pid {sender.pid})", "header.stamp.nsec is 1999999999")


def test_an_interface_that_is_down(world: Any, ip: Any) -> None:
    world.node("talker")
    world.node("listener")
    ip("link", "set", "lo", "down")
    found = world.finds("bus", "the interface lo is down")
    (command,) = [word for word in found.commands if "route add" in word]
    world.type(command)
    world.is_silent()


def test_watch_tells_when_a_finding_grows(world: Any) -> None:
    world.sends(_twist("A"))
    watch = world.start(world.command, "wtf", "--watch", "--json", "--wait", "0.3s")
    world.node("listener", "__name:=one", "chatter:=/one")
    assert "/one" in json.loads(watch.wait_for("appeared"))["items"]
    world.node("listener", "__name:=two", "chatter:=/two")
    assert "/two" in json.loads(watch.wait_for("changed"))["items"]


def test_simulated_time_that_nobody_publishes(world: Any) -> None:
    talker = world.node("talker", "_use_sim_time:=true")
    world.node("listener")
    found = world.finds("no-clock", f"/talker (pid {talker.pid})", "lcmtools run sim")
    assert (found.severity, found.remedies[0]) == (
        "error",
        "start /talker without _use_sim_time:=true",
    )
    world.again(talker, without="_use_sim_time:=true")
    world.is_silent()


def test_two_simulators_of_one_robot_are_one_finding(world: Any) -> None:
    for name in ("morse", "other"):
        world.node("sim", "--world", "husky", f"__name:={name}")
    world.tool("echo", "/husky0/odometry")
    world.tool("pub", "-r", "10", "/husky0/velocity_cmd", "geometry_msgs/Twist", "{}")
    found = world.finds("competing-publishers", "/morse", "/other", "/husky0/odometry")
    assert "2 programs publish on /clock and " in found.text
    world.end(world.of_node("/other"))
    world.is_silent()


def test_a_java_program_that_is_frozen(world: Any) -> None:
    world.hears("A")
    sender = world.java("Sends", "A", "2e7c07d7cdf7e027", "56", "20")
    sender.send_signal(signal.SIGSTOP)
    found = world.finds("silent", f"(pid {sender.pid})")
    world.type(found.commands[0])
    world.is_silent()
