"""Faults in messages: lost, from two, slower, slow simulated time, odd values, wrong types."""

import signal

import pytest

RATES = """
import signal, sys
import lcmtools
from lcmtools.types.std_msgs import Int32
class Beat(lcmtools.Node):
    def __init__(self):
        super().__init__("beat")
        self.out, self.number, self.every = self.create_publisher(Int32, "/beat"), 0, 1
        self.create_timer(0.01, self.beat)
    def beat(self):
        self.number += 1
        if self.number % self.every == 0:
            self.out.publish(Int32())
lcmtools.init()
node = Beat()
signal.signal(signal.SIGUSR1, lambda *_: setattr(node, "every", int(sys.argv[1])))
signal.signal(signal.SIGUSR2, lambda *_: setattr(node, "every", 1))
lcmtools.spin(node)
"""
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
NAN_IN_COVARIANCE = "m = ODOM; m.pose.covariance[7] = math.nan"
ODOM = "Odometry(); m.pose.pose.orientation.w = 1.0; m.header.stamp = now"
GOOD = f"m = {ODOM}; SEND"


def test_two_plain_programs_steer_the_same_actuator(world):
    world.hears("/cmd_vel")
    first, second = (world.sends("bus.publish('/cmd_vel', Twist().encode())") for _ in "ab")
    world.finds("competing-publishers", first.pid, second.pid, "/cmd_vel", "end one of them")
    world.end(first)
    world.is_silent()


@pytest.mark.parametrize("options", [("-r", "0.2"), ("--latch",)], ids=" ".join)
def test_a_command_that_was_left_over_steers_too(world, options):
    world.hears("/cmd_vel")
    program = world.sends("bus.publish('/cmd_vel', Twist().encode())")
    left = world.tool("pub", *options, "/cmd_vel", "geometry_msgs/Twist", "{}")
    world.until(lambda: left.pid in world.pids())
    world.finds("competing-publishers", program.pid, left.pid, "/cmd_vel", "end one of them")
    world.end(left)
    world.is_silent()


def test_a_sender_whose_messages_get_lost(world):
    sender = world.script(SKIPS, "10", ready="sends")
    world.finds("loss", sender.pid, "before they left it")
    world.end(sender)
    world.script(SKIPS, "1000000", ready="sends")
    world.is_silent()


def _beating(world, every):
    """A node that has beaten long enough to have a usual rate, and a command that listens."""
    beat = world.script(RATES, str(every))
    world.until(lambda: beat.pid in world.pids())
    world.tool("hz", "/beat")
    world.until(lambda: _beats(world) > 150)
    return beat


def _beats(world):
    ends = [end for node in world.graph().nodes for end in node.endpoints]
    return max((end.messages for end in ends if end.topic == "/beat"), default=0)


def test_a_node_that_has_become_slower(world):
    beat = _beating(world, 10)
    beat.send_signal(signal.SIGUSR1)
    world.finds("slow-rate", "/beat", " Hz instead of ", wait="0.6s")
    beat.send_signal(signal.SIGUSR2)
    world.is_silent()


def test_a_plain_publisher_that_is_frozen(world):
    """Nothing of it is on the bus any more: its process tells."""
    world.node("talker")
    world.node("listener")
    sender = world.c("sends", "POSE", "00", "100", "50")
    sender.send_signal(signal.SIGSTOP)
    world.obey(world.finds("silent", f"(pid {sender.pid})", f"kill -CONT {sender.pid}"))
    world.is_silent()


def test_a_simulator_that_was_made_slow(world):
    world.node("sim", "--world", "empty")
    world.type("lcmtools sim set-rate 0.4")
    found = world.finds("slow-simulator", "/gazebo", "0.4", wait="0.8s")
    world.obey(found)
    world.is_silent()


def test_large_messages_of_which_a_part_never_comes(world):
    sender = world.script(RAW, "part(3000, 0, 0, 3, bytes(1000))", ready="sends")
    world.finds("loss", f"(pid {sender.pid})", "before they left it")


def test_a_node_that_receives_large_messages_without_their_ends(world):
    listener = world.script(EAR)
    world.until(lambda: listener.pid in world.pids())
    sender = world.script(RAW, "part(3000, 0, 0, 3, bytes(1000))", ready="sends")
    (found,) = world.look("--rule", "incomplete-messages", wait="2.5s")
    assert found.items[0].startswith("/ear lost ")
    assert found.items[0].endswith(" large messages of 'BIG': parts of them did not arrive")
    assert "smaller messages on 'BIG'" in found.remedies[0]
    world.end(sender)
    world.script(RAW, "part(1000, 0, 0, 1, bytes(1000))", ready="sends")
    world.until(lambda: not world.look("--rule", "incomplete-messages", wait="1.2s"))


def _sends(world, statements):
    made = statements.replace("ODOM", ODOM)
    stamp = "now = Time(); now.sec = int(time.time()); "
    return world.sends(stamp + made.replace("SEND", "bus.publish('/it', m.encode())"), 0.03)


@pytest.mark.parametrize(
    ("statements", "rule", "what"),
    [
        (f"{NAN_IN_COVARIANCE}; SEND", "not-finite", "pose.covariance[7] is nan"),
        ("m = ODOM; bus.publish('/it', m.encode()[:-5])", "undecodable", "nav_msgs/Odometry"),
        (
            "m = ODOM; m.pose.covariance[1] = 0.5; SEND",
            "covariances",
            "pose.covariance is not symmetric: [6] and [1] are 0 and 0.5",
        ),
        (
            "m = ODOM; m.header.stamp.sec = 1_600_000_000; SEND",
            "stamps",
            "a time long ago",
        ),
    ],
)
def test_odd_contents(world, statements, rule, what):
    sender = _sends(world, statements)
    found = world.finds(rule, "/it from ", f"(pid {sender.pid})", what, wait="0.3s")
    assert found.severity == "warning"
    world.end(sender)
    _sends(world, GOOD)
    world.is_silent(wait="0.3s")


def test_a_c_program_with_another_fingerprint(world):
    world.node("listener")
    sender = world.c("sends", "/chatter", "2e7c07d7cdf7e027", "56", "20")
    world.finds("type-mismatch", sender.pid, "geometry_msgs/Twist", "std_msgs/String")
    world.end(sender)
    world.node("talker")
    world.is_silent()


def test_of_java_programs_that_share_a_port_the_candidates_are_named(world):
    world.node("listener")
    ears = world.java("Listens", "/other")
    sender = world.java("Sends", "/chatter", "2e7c07d7cdf7e027", "56", "20")
    world.finds("type-mismatch", f"(pid {ears.pid})", f"(pid {sender.pid})", " or ")


def test_programs_that_send_on_one_channel_from_one_port_as_those_of_java_do(world):
    words = "DRIVE", "bytes.fromhex('2e7c07d7cdf7e027') + bytes(48)"  # geometry_msgs/Twist
    one, other = (world.script(SHARES, *words, ready="sends") for _ in range(2))
    named = (f"(pid {one.pid})", f"(pid {other.pid})")
    world.finds("competing-publishers", "2 programs", *named, wait="1s")
    world.end(other)
    world.is_silent(wait="1s")


def test_of_programs_that_share_a_port_as_those_of_java_do_one_sends_elsewhere(world):
    world.node("listener")
    head = "bytes.fromhex('2e7c07d7cdf7e027') + bytes(48)"  # geometry_msgs/Twist
    sender = world.script(SHARES, "/chatter", head, ready="sends")
    other = world.script(SHARES, "/other", "bytes(8)", ready="sends")
    found = world.finds("type-mismatch", f"(pid {sender.pid})", f"(pid {other.pid})", " or ")
    assert "another channel" in found.everything or "/chatter:=/chatter_2" in found.everything
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
    found = world.finds("unknown-type", sender.pid, "not LCM messages", f"): {form}")
    assert found.severity == "note"
    world.end(sender)
    world.sends("bus.publish('IT', Twist().encode())")
    world.is_silent()


def test_a_log_of_yesterday_is_played_again(world):
    sender = _sends(world, f"now.sec -= 86400; now.nsec = int(time.time() % 1 * 1e9); {GOOD}")
    found = world.finds("stamps", f"(pid {sender.pid})", "as if a log were played", wait="0.5s")
    assert found.severity == "note"


def test_a_channel_that_is_not_utf_8(world):
    datagram = r"b'LC02' + struct.pack('>I', number) + b'caf\xe9\0' + bytes(16)"
    sender = world.script(RAW, datagram, ready="sends")
    world.finds("names", sender.pid, r"'caf\xe9'", "it is not UTF-8")


def test_a_type_of_which_nothing_is_known_here(world):
    world.hears("STATE")
    fingerprint = world.fingerprint("package own; struct State { int16_t wheels[4]; }")
    sender = world.c("sends", "STATE", fingerprint, "16", "20")
    found = world.finds("unknown-type", sender.pid, f"0x{fingerprint}", "LCMTOOLS_TYPE_PATH")
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
    world.finds(
        "type-mismatch", sender.pid, "/ear", "geometry_msgs/Pose2D", "without the field theta"
    )
    world.end(sender)
    world.sends("bus.publish('/at', Pose2D().encode())")
    world.is_silent()


@pytest.mark.parametrize(
    ("old", "new", "difference"),
    [
        ("double x; double y;", "double x; double y; int64_t utime;", "with utime (int64) at the"),
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
    found = world.finds("unknown-type", "'STATE' from", f"own/state, but {difference}", **path)
    assert [action["kind"] for action in found.actions] == ["same-lcm-files"]
    file.write_text(new)
    world.is_silent(**path)


def test_two_versions_of_a_type_among_plain_programs(world):
    fingerprint = world.fingerprint("package old; struct Pose2D { double x; double y; }")
    sender = world.c("sends", "POSE", fingerprint, "16", "20")
    world.sends("bus.publish('POSE', Pose2D().encode())")
    like = "like geometry_msgs/Pose2D, but without the field theta"
    older = f"the older version is probably that of sends POSE {fingerprint}"
    world.finds("type-mismatch", sender.pid, like, older)
