"""Faults in messages: lost, from two, slower, slow simulated time, odd values, wrong types."""

import pytest

SKIPS = """
import socket, sys, time
sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
number = 0
while True:
    number += 1
    if number % int(sys.argv[1]):
        data = b"LC02" + number.to_bytes(4, "big") + b"SKIP\\0"
        sender.sendto(data, ("239.255.76.67", 7667))
    if number == 3:
        print("sends", flush=True)
    time.sleep(0.01)
"""
RAW = """
import socket, struct, sys, time
out, number = socket.socket(socket.AF_INET, socket.SOCK_DGRAM), 0
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
SHARES = """
import socket, struct, sys, time
out, number = socket.socket(socket.AF_INET, socket.SOCK_DGRAM), 0
out.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
out.bind(("", 7667))
while True:
    number += 1
    head = b"LC02" + struct.pack(">I", number) + sys.argv[1].encode() + b"\\0"
    out.sendto(head + eval(sys.argv[2]), ("239.255.76.67", 7667))
    if number == 3:
        print("sends", flush=True)
    time.sleep(0.05)
"""
EAR = """
import lcmtools
from lcmtools.types.std_msgs import Int32
lcmtools.init()
node = lcmtools.Node("ear")
node.create_subscription(Int32, "BIG", lambda _: None, 10, plain_channel=True)
lcmtools.spin(node)
"""
ODOM = "Odometry(); m.pose.pose.orientation.w = 1.0; m.header.stamp = now"
GOOD = f"m = {ODOM}; SEND"


@pytest.mark.parametrize("options", [("-r", "0.2"), ("--latch",)], ids=" ".join)
def test_a_command_that_was_left_over_steers_too(world, options):
    world.hears("/cmd_vel")
    program = world.sends("bus.publish('/cmd_vel', Twist().encode())")
    left = world.tool("pub", *options, "/cmd_vel", "geometry_msgs/Twist", "{}")
    world.until(lambda: left.pid in world.pids())
    world.finds("competing-publishers", program.pid, left.pid, "/cmd_vel")
    world.end(left)
    world.is_silent()


def test_a_sender_whose_messages_get_lost(world):
    sender = world.script(SKIPS, "10", ready="sends")
    world.finds("loss", sender.pid, "lost-in-sender")
    world.end(sender)
    world.script(SKIPS, "1000000", ready="sends")
    world.is_silent()


def test_a_simulator_that_was_made_slow(world):
    world.node("sim", "--world", "empty")
    world.type("lcmtools sim set-rate 0.4")
    found = world.finds("slow-simulator", "/gazebo", wait="0.8s")
    assert found.values["ratio"] == pytest.approx(0.4, abs=0.05)
    world.obey(found)
    world.is_silent()


def test_a_node_that_receives_large_messages_without_their_ends(world):
    listener = world.script(EAR)
    world.until(lambda: listener.pid in world.pids())
    sender = world.script(RAW, "part(3000, 0, 0, 3, bytes(1000))", ready="sends")
    (found,) = world.look("--rule", "incomplete-messages", wait="2.5s")
    assert [(one["node"], one["topic"]) for one in found.facts] == [("/ear", "BIG")]
    world.end(sender)
    world.script(RAW, "part(1000, 0, 0, 1, bytes(1000))", ready="sends")
    world.until(lambda: not world.look("--rule", "incomplete-messages", wait="1.2s"))


def _sends(world, statements):
    made = statements.replace("ODOM", ODOM)
    stamp = "now = Time(); now.sec = int(time.time()); "
    return world.sends(stamp + made.replace("SEND", "bus.publish('/it', m.encode())"), 0.03)


def test_of_java_programs_that_share_a_port_the_candidates_are_named(world):
    world.node("listener")
    ears = world.java("Listens", "/other")
    sender = world.java("Sends", "/chatter", "2e7c07d7cdf7e027", "56", "20")
    world.finds("type-mismatch", ears.pid, sender.pid)


def test_programs_that_send_on_one_channel_from_one_port_as_those_of_java_do(world):
    words = "DRIVE", "bytes.fromhex('2e7c07d7cdf7e027') + bytes(48)"  # geometry_msgs/Twist
    one, other = (world.script(SHARES, *words, ready="sends") for _ in range(2))
    world.finds("competing-publishers", one.pid, other.pid, wait="1s")
    world.end(other)
    world.is_silent(wait="1s")


def test_of_programs_that_share_a_port_as_those_of_java_do_one_sends_elsewhere(world):
    world.node("listener")
    head = "bytes.fromhex('2e7c07d7cdf7e027') + bytes(48)"  # geometry_msgs/Twist
    sender = world.script(SHARES, "/chatter", head, ready="sends")
    other = world.script(SHARES, "/other", "bytes(8)", ready="sends")
    world.finds("type-mismatch", sender.pid, other.pid)
    world.end(sender)
    world.end(other)
    world.node("talker")
    world.is_silent()


@pytest.mark.parametrize(
    ("payload", "form"),
    [
        ("b'{\"speed\": %d}' % number", "JSON"),
        ("b'{}'", "JSON"),
        ("b'[%d]' % number", "JSON"),
        ("b'speed=%d' % number", "text"),
        ("bytes([8, number % 100, 18, 5]) + b'hello'", "protobuf"),
    ],
)
def test_payloads_that_are_no_lcm_messages(world, payload, form):
    world.hears("IT")
    sender = world.sends(f"bus.publish('IT', {payload})")
    found = world.finds("unknown-type", sender.pid, "no-lcm-messages", form)
    assert found.severity == "note"
    world.end(sender)
    world.sends("bus.publish('IT', Twist().encode())")
    world.is_silent()


def test_a_log_of_yesterday_is_played_again(world):
    sender = _sends(world, f"now.sec -= 86400; now.nsec = int(time.time() % 1 * 1e9); {GOOD}")
    found = world.finds("stamps", sender.pid, "replayed", wait="0.5s")
    assert found.severity == "note"


def test_a_channel_that_is_not_utf_8(world):
    datagram = r"b'LC02' + struct.pack('>I', number) + b'caf\xe9\0' + bytes(16)"
    sender = world.script(RAW, datagram, ready="sends")
    world.finds("names", sender.pid, "odd-channel")


def test_a_type_of_which_nothing_is_known_here(world):
    world.hears("STATE")
    fingerprint = world.fingerprint("package own; struct State { int16_t wheels[4]; }")
    sender = world.c("sends", "STATE", fingerprint, "16", "20")
    found = world.finds("unknown-type", sender.pid, f"0x{fingerprint}", "type-path")
    assert found.severity == "note"


def test_an_old_definition_of_a_message(world):
    fingerprint = world.fingerprint("package old; struct Pose2D { double x; double y; }")
    hears = (
        "import lcmtools\nfrom lcmtools.types.geometry_msgs import Pose2D\nlcmtools.init()\n"
        "node = lcmtools.Node('ear')\n"
        "node.create_subscription(Pose2D, '/at', lambda _: None, 10)\nlcmtools.spin(node)\n"
    )
    listener = world.script(hears)
    world.until(lambda: listener.pid in world.pids())
    sender = world.c("sends", "/at", fingerprint, "32", "20")
    world.finds("type-mismatch", sender.pid, "/ear", "geometry_msgs/Pose2D", "theta")
    world.end(sender)
    world.sends("bus.publish('/at', Pose2D().encode())")
    world.is_silent()


@pytest.mark.parametrize(
    ("old", "new", "difference"),
    [
        ("double x; double y;", "double x; double y; int64_t utime;", "utime (int64)"),
        ("double x; double y;", "double x; float y;", "y is float32, not float64"),
    ],
)
def test_an_older_type_on_the_path(world, tmp_path, old, new, difference):
    old, new = (f"package own; struct state {{ {fields} }}" for fields in (old, new))
    world.hears("STATE")
    world.c("sends", "STATE", world.fingerprint(new), "32" if "y; " in new else "20", "20")
    file = tmp_path / "types/state.lcm"
    file.parent.mkdir()
    file.write_text(old)
    path = {"LCMTOOLS_TYPE_PATH": str(file.parent)}
    found = world.finds("unknown-type", "STATE", "own/state", difference, **path)
    assert found.kinds == ["same-lcm-files"]
    file.write_text(new)
    world.is_silent(**path)


def test_two_versions_of_a_type_among_plain_programs(world):
    fingerprint = world.fingerprint("package old; struct Pose2D { double x; double y; }")
    sender = world.c("sends", "POSE", fingerprint, "16", "20")
    world.sends("bus.publish('POSE', Pose2D().encode())")
    world.finds("type-mismatch", sender.pid, "geometry_msgs/Pose2D", "theta", "older-type")
