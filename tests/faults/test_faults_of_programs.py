"""Faults of programs: not connected, killed, stopped, hanging, with a small buffer; and --watch."""

import json
import signal
import time
from pathlib import Path

import pytest

from lcmtools.messages.registry import fingerprint
from lcmtools.types.std_msgs import Empty

UNFED = "unconnected-subscriptions"
STEER = ("pub", "-r", "10", "/husky0/desired_velocity", "geometry_msgs/Twist", "{}")

LARGE = (f"{fingerprint(Empty):016x}", "1500000", "5")
BURSTS = "m = String(); m.data = 1000 * 'x'; [bus.publish('A', m.encode()) for _ in range(150)]"
HANGS = """
import socket, struct, time
ear = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
ear.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
ear.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
ear.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 5000)
ear.bind(("239.255.76.67", 7667))
group = socket.inet_aton("239.255.76.67")
ear.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group + socket.inet_aton("0.0.0.0"))
print("listens", flush=True)
time.sleep(1000)
"""


def test_a_controller_without_its_namespace_and_remap(world):
    """The Husky lab's own: two flags are missing, one after the other."""
    world.node("sim", "--world", "husky")
    world.node("simple_controller")
    world.tool("pub", "-r", "10", "/husky0/desired_velocity", "geometry_msgs/Twist", "{}")
    found = world.finds(
        UNFED, "/simple_controller", "/odometry", "/desired_velocity", "/husky0/velocity_cmd"
    )
    assert found.actions[0]["namespace"] == "/husky0"
    world.obey(found)
    found = world.finds(UNFED, "/husky0/velocity_cmd", "controlled_velocity")
    world.obey(found)
    world.is_silent()


def test_a_simulator_that_was_killed_is_the_only_finding(world):
    sim = world.node("sim", "--world", "husky")
    world.node("simple_controller", "__ns:=/husky0", "controlled_velocity:=velocity_cmd")
    world.tool(*STEER)
    world.is_silent()
    sim.send_signal(signal.SIGKILL)
    sim.wait()
    world.finds("stale-nodes", "/morse", sim.pid)
    world.node("sim", "--world", "husky")
    world.is_silent()


def test_a_stopped_listener(world):
    listener = world.lcm("lcm-sink")
    world.sends("m = String(); m.data = 5000 * 'x'; bus.publish('A', m.encode())", 0.005)
    listener.send_signal(signal.SIGSTOP)
    found = world.finds("stuck-listeners", listener.pid, "stopped")
    assert found.commands == [f"kill -CONT {listener.pid}", f"kill -KILL {listener.pid}"]
    world.type(found.commands[0])
    world.is_silent()


def test_a_stopped_listener_is_ended(world):
    world.node("talker")
    listener = world.node("listener")
    listener.wait_for("I heard")
    world.is_silent()  # it is announced, and so its record has its topics
    listener.send_signal(signal.SIGSTOP)
    found = world.finds("stale-nodes", "/listener", listener.pid)
    world.type(found.commands[1])
    assert listener.wait(timeout=10) == -signal.SIGKILL


def test_a_listener_that_hangs(world):
    world.sends("m = String(); m.data = 5000 * 'x'; bus.publish('A', m.encode())", 0.005)
    listener = world.script(HANGS, ready="listens")
    world.finds("stuck-listeners", "bytes-wait", f"py-spy dump --pid {listener.pid}")
    world.end(listener)
    world.hears("A")
    world.is_silent()


_IN_A_CALLBACK = """
import sys, time, lcm
bus, count = lcm.LCM(), 0
def called(channel, data):
    global count
    count += 1
    while count > 3:
        exec(sys.argv[1])
bus.subscribe("A", called)
print("listens", flush=True)
while True:
    bus.handle()
"""


@pytest.mark.parametrize("does", ["time.sleep(1000)", "pass"], ids=["waits", "computes"])
@pytest.mark.parametrize("period", [0.005, 0.5])
def test_a_plain_program_whose_callback_does_not_return(world, does, period):
    """The thread of liblcm still empties its socket."""
    world.node("talker")
    world.node("listener")
    world.sends("bus.publish('A', String().encode())", period)
    listener = world.script(_IN_A_CALLBACK, does, ready="listens")
    time.sleep(5 * period + 0.2)
    found = world.finds("stuck-listeners", listener.pid, "messages-wait")
    assert found.commands == [f"py-spy dump --pid {listener.pid}"]
    world.end(listener)
    world.script(_IN_A_CALLBACK, "globals().update(count=0)", ready="listens")
    world.is_silent()


def test_a_plain_program_that_handles_its_messages_once_a_second(world):
    world.sends("bus.publish('A', String().encode())")
    source = _IN_A_CALLBACK.replace("bus.handle()", "time.sleep(1); bus.handle()")
    world.script(source.replace("count > 3", "False"), ready="listens")
    world.is_silent()


EARS = """
import sys, lcmtools
from lcmtools.types.std_msgs import String
lcmtools.init()
node = lcmtools.Node("ear")
node.create_subscription(String, "/chatter", lambda _: None, 10)
lcmtools.spin(node)
"""


def test_a_command_in_a_namespace_that_is_mistyped(world):
    world.node("listener", "__ns:=/husky0")
    pub = world.tool("pub", "-r", "5", "/husky/chatter", "std_msgs/String", "data: hi")
    world.until(lambda: pub.pid in world.pids())
    world.finds("unconnected-subscriptions", "/husky0/chatter")


def test_a_message_that_no_usual_buffer_takes(world):
    sink = world.lcm("lcm-sink")
    sender = world.c("sends", "CAM", *LARGE)
    found = world.finds("small-buffer", sender.pid, sink.pid)
    world.again(sink, **found.variables)
    world.is_silent()


def test_bursts_that_a_small_buffer_does_not_take(world):
    url = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2500"
    sink = world.hears("A", LCM_DEFAULT_URL=url)
    sender = world.sends(BURSTS, 0.05)
    found = world.finds("kernel-drops", sink.pid)
    world.again(sink, **found.variables)
    world.is_silent()
    assert sender.pid


def test_bursts_beside_a_larger_message(world):
    """What a program drops is told also while its buffer is too small for another message."""
    url = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2500"
    sink = world.hears("A", "B", LCM_DEFAULT_URL=url)
    world.sends(BURSTS.replace("150", "1500"), 0.5)
    world.sends("bus.publish('B', String().encode() + bytes(400_000))", 0.5)
    (found,) = world.look("--rule", "kernel-drops", wait="1.2s")
    assert str(sink.pid) in found.everything
    found = world.finds("small-buffer", sink.pid, "recv_buf_size=4194304", wait="1.2s")
    world.obey(found)
    world.is_silent(wait="1.2s")


def test_a_program_with_nearly_all_files_open(world):
    command = "import sys; kept = [open('/dev/null') for _ in range(960)]\n"
    hears = (
        "import lcm, time\nbus = lcm.LCM()\nbus.subscribe('A', print)\n"
        "print('listens', flush=True)\ntime.sleep(1000)\n"
    )
    world.node("talker")
    world.node("listener")
    program = world.script(f"{hears.rpartition('time')[0]}{command}time.sleep(1000)\n")
    program.wait_for("listens")
    world.until(lambda: len(list(Path(f"/proc/{program.pid}/fd").iterdir())) > 960)
    found = world.finds("open-files", program.pid)
    world.end(program)
    world.script(hears, ready="listens")
    world.is_silent()
    assert found.severity == "warning"


def test_watch_shows_what_appears_and_clears(world):
    world.sends("bus.publish('/good', Twist().encode())")
    watch = world.start(world.command, "wtf", "--watch", "--json", "--wait", "0.3s")
    text = world.start(world.command, "wtf", "--watch", "--wait", "0.3s")
    text.wait_for("No errors or warnings")
    bad = world.sends("m = Twist(); m.linear.x = math.nan; bus.publish('/bad', m.encode())")
    appeared = json.loads(watch.wait_for("appeared"))
    assert (appeared["change"], appeared["rule"]) == ("appeared", "not-finite")
    text.wait_for("WARNING Numbers that are published are not finite:")
    world.end(bad)
    assert json.loads(watch.wait_for("cleared"))["rule"] == "not-finite"
    text.wait_for("CLEARED Numbers that are published are not finite:")
    for program in (watch, text):
        program.send_signal(signal.SIGINT)
        assert program.wait() == 130
    world.is_silent()


def test_a_node_that_ends_during_a_look_is_no_plain_program(world):
    world.tool("pub", "-r", "20", "/pose", "geometry_msgs/Pose", "{orientation: {w: 1}}")
    ends = world.tool("pub", "-r", "20", "/pose", "geometry_msgs/Quaternion", "{}")
    name = world.node_of(ends).name
    look = world.start(world.command, "wtf", "--json", "--wait", "4s")
    world.until(lambda: world.listens(look))
    begin = _sent(world, ends)
    world.until(lambda: _sent(world, ends) > begin + 20)
    world.end(ends)
    look.wait()
    found = [one for one in json.loads("\n".join(look.lines)) if one["severity"] != "unchecked"]
    assert [one["rule"] for one in found] == ["quaternions"]
    assert name in str(found)


def test_a_publisher_that_is_gone(world):
    talker = world.node("talker")
    world.node("listener").wait_for("I heard")
    world.is_silent()
    world.end(talker)
    found = world.finds(UNFED, "/listener", "/chatter", wait="3s")
    assert found.severity == "warning"
    world.node("talker")
    world.is_silent()


@pytest.mark.parametrize("program", ["nothing", "a quiet one"])
def test_a_plain_publisher_that_is_gone(world, program):
    sender = world.sends("m = String(); bus.publish('/chatter', m.encode())")
    world.node("listener").wait_for("I heard")
    if program == "a quiet one":  # it did not send what came before
        world.script(SELDOM, ready="runs")
    world.is_silent()
    world.end(sender)
    assert world.finds(UNFED, "/listener", "/chatter", wait="1s").severity == "warning"
    world.sends("m = String(); bus.publish('/chatter', m.encode())")
    world.is_silent()


def test_a_topic_that_nothing_publishes(world):
    world.node("listener")
    found = world.finds(UNFED, "/chatter")
    assert found.kinds == ["start-publisher"]
    world.node("talker")
    world.is_silent()


def test_a_node_without_spin_is_told_before_its_queue_is_full(world):
    world.sends("bus.publish('/chatter', String().encode())", 0.5)
    source = EARS.replace("None, 10)", "None, 1000)")  # however late the look is
    ear = world.script(source.replace("lcmtools.spin(node)", "import time; time.sleep(1000)"))
    world.until(lambda: _received(world) > 5)
    world.finds("slow-callbacks", "/ear")
    world.end(ear)
    ear = world.script(EARS)
    world.until(lambda: ear.pid in world.pids() and _received(world) > 5)
    world.is_silent()


def _sent(world, program):
    return max(end.messages for end in world.node_of(program).endpoints)


def _received(world):
    ends = [end for node in world.graph().nodes for end in node.endpoints]
    return max((end.messages for end in ends if end.topic == "/chatter"), default=0)


SELDOM = """
import lcm, time
bus = lcm.LCM()
bus.publish("/other", b"")
print("runs", flush=True)
time.sleep(1000)
"""


def test_what_a_quiet_program_may_publish_is_a_note(world):
    world.node("listener")
    assert world.finds(UNFED).severity == "warning"
    program = world.script(SELDOM, ready="runs")
    found = world.finds(UNFED, program.pid, "may-publish")
    assert found.severity == "note"


def test_a_stopped_java_program_is_called_by_its_class(world):
    listener = world.java("Listens", "/cmd_vel")
    world.c("sends", "/cmd_vel", "2e7c07d7cdf7e027", "56", "100")
    listener.send_signal(signal.SIGSTOP)
    found = world.finds("stuck-listeners", f"Listens /cmd_vel (pid {listener.pid})")
    world.obey(found)
    world.is_silent()


_OF_SERVICES = """
import sys, lcmtools
from lcmtools.types.std_srvs import Trigger
lcmtools.init()
node = lcmtools.Node(sys.argv[1])
if sys.argv[2] == "offers":
    node.create_service(Trigger, "go", lambda request, response: response)
else:
    node.create_client(Trigger, "go")
lcmtools.spin(node)
"""


def _of_services(world, *arguments):
    program = world.script(_OF_SERVICES, *arguments)
    world.until(lambda: program.pid in world.pids())
    return program


def test_a_service_that_two_nodes_offer(world):
    _of_services(world, "arm", "offers")
    _of_services(world, "pilot", "calls")
    second = _of_services(world, "leg", "offers")
    world.obey(world.finds("services", "/go", "/arm", "/leg", second.pid))
    world.is_silent()


def test_a_service_that_no_node_offers(world):
    _of_services(world, "pilot", "calls")
    found = world.finds("services", "/pilot", "/go")
    assert found.kinds == ["start-server"]
    _of_services(world, "arm", "offers", "__ns:=/left")
    world.obey(world.finds("services", "/pilot", "/left/go"))
    world.is_silent()
