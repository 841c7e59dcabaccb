"""Publishers that fall silent or become slow, and programs that only look as if they had."""

import signal
import time

_SWITCHED = """
import signal, sys, time, lcm
from lcmtools.types.std_msgs import String
bus, periods = lcm.LCM(), [float(word) for word in sys.argv[2:]]
signal.signal(signal.SIGUSR1, lambda *_: periods.pop(0))
print("runs", flush=True)
while True:
    bus.publish(sys.argv[1], String().encode())
    time.sleep(periods[0])
"""
_NODE = """
import signal, sys, lcmtools
from lcmtools.types.std_msgs import String
lcmtools.init()
node, count, periods = lcmtools.Node("beat"), 0, [1, 10, 1]
publisher = node.create_publisher(String, "/beat")
def tick():
    global count
    count += 1
    if count % periods[0] == 0:
        publisher.publish(String())
signal.signal(signal.SIGUSR1, lambda *_: print("slower", periods.pop(0), flush=True))
node.create_timer(0.1, tick)
print("runs", flush=True)
lcmtools.spin(node)
"""
_RESTARTED = """
import subprocess, sys, time
source = '''
import lcm, time
from lcmtools.types.std_msgs import String
bus = lcm.LCM()
for _ in range(8):
    bus.publish("A", String().encode())
    time.sleep(0.05)
'''
print("runs", flush=True)
while True:
    subprocess.run([sys.executable, "-c", source], check=True)
"""


_NAN = "m = Twist(); m.linear.x = math.nan; bus.publish('/bad', m.encode())"


def _watched(world):
    """``wtf --watch``, after its first look, which finds nothing."""
    watch = world.start(world.command, "wtf", "--watch", "--wait", "1s")
    watch.wait_for("No errors or warnings")
    return watch


def _let_it_look_again(world, watch):
    """Plant another fault, and mend it: both are seen by later looks."""
    bad = world.sends(_NAN)
    watch.wait_for("are not finite")
    world.end(bad)
    watch.wait_for("CLEARED Numbers")


def test_a_plain_program_that_falls_silent_is_told_until_it_ends(world):
    sender = world.script(_SWITCHED, "A", "0.05", "1000", ready="runs")
    watch = _watched(world)
    sender.send_signal(signal.SIGUSR1)
    watch.wait_for("have stopped publishing")
    assert str(sender.pid) in watch.wait_for("'A', ")
    _let_it_look_again(world, watch)
    assert "CLEARED The following have stopped" not in watch.output
    world.end(sender)
    watch.wait_for("CLEARED The following have stopped")


def test_a_plain_program_that_becomes_slow_is_told_for_as_long_as_it_is(world):
    sender = world.script(_SWITCHED, "A", "0.1", "1", "0.1", ready="runs")
    watch = _watched(world)
    sender.send_signal(signal.SIGUSR1)
    watch.wait_for("NOTE The following have become slower")
    _let_it_look_again(world, watch)
    assert "CLEARED The following have become slower" not in watch.output
    sender.send_signal(signal.SIGUSR1)
    watch.wait_for("CLEARED The following have become slower")


def test_one_look_compares_a_plain_program_with_its_average(world):
    sender = world.script(_SWITCHED, "A", "0.02", "0.5", "0.02", ready="runs")
    time.sleep(6.0)
    world.is_silent()
    sender.send_signal(signal.SIGUSR1)
    world.finds("slow-rate", sender.pid, "slower-program", wait="1s")


def _beats(world):
    ends = [end for node in world.graph().nodes for end in node.endpoints]
    return max((end.messages for end in ends if end.topic == "/beat"), default=0)


def test_a_node_that_falls_from_ten_messages_a_second_to_one(world):
    beat = world.script(_NODE, ready="runs")
    world.start(world.command, "echo", "/beat")
    world.until(lambda: _beats(world) > 40)
    world.is_silent()
    beat.send_signal(signal.SIGUSR1)
    beat.wait_for("slower")
    sent = _beats(world)
    world.until(lambda: _beats(world) > sent)
    found = world.finds("slow-rate", "/beat", "slower")
    assert found.severity == "note"


def test_a_program_that_publishes_once_in_five_seconds(world):
    world.script(_SWITCHED, "/chatter", "5", ready="runs")
    listener = world.node("listener")
    for _ in range(2):
        listener.wait_for("heard")
    for _ in range(8):  # with and without a message
        world.is_silent(wait="1s")


def test_a_program_that_is_started_again_and_again(world):
    world.script(_RESTARTED, ready="runs")
    for _ in range(4):
        world.is_silent(wait="1s")


def test_two_slow_programs_publish_the_same(world):
    for _ in "ab":
        world.script(_SWITCHED, "/goal", "0.7", ready="runs")
    found = world.finds("competing-publishers", "/goal", wait="1s")
    assert found.severity == "warning"


def test_a_listener_that_is_stopped_and_continued_all_the_time(world):
    world.sends("bus.publish('A', String().encode())")
    listener = world.hears("A")
    source = (
        "import os, signal, sys, time\nprint('runs', flush=True)\nwhile True:\n"
        "    for number in (signal.SIGSTOP, signal.SIGCONT):\n"
        "        os.kill(int(sys.argv[1]), number)\n        time.sleep(0.05)\n"
    )
    world.script(source, str(listener.pid), ready="runs")
    for _ in range(4):
        world.is_silent()


def test_a_simulator_that_has_too_much_to_do(world):
    world.node("sim", "--world", "pioneer", "--rate", "6")
    cameras = ("depth/image_raw", "depth/points", "rgb/image_raw")
    viewers = [world.start(world.command, "hz", f"/camera/{name}") for name in cameras]

    found = []

    def is_found():
        found[:] = world.look("--rule", "slow-simulator", wait="0.8s")
        return bool(found)

    world.until(is_found)
    (slow,) = found
    assert slow.kinds == ["simulate-less"]
    for viewer in viewers:
        world.end(viewer)
    world.until(lambda: not is_found())


_CLOCK = """
import lcm, time
from lcmtools.types.rosgraph_msgs import Clock
bus, message, start = lcm.LCM(), Clock(), time.monotonic()
print("runs", flush=True)
while True:
    message.clock.sec, rest = divmod((time.monotonic() - start) / 3, 1)
    message.clock.sec, message.clock.nsec = int(message.clock.sec), int(rest * 1e9)
    bus.publish("/clock", message.encode())
    time.sleep(0.6)
"""


def test_a_slow_clock_that_seldom_ticks(world):
    clock = world.script(_CLOCK, ready="runs")
    for _ in range(2):
        # the first look hears at least one tick, and a tick may be sent or arrive late
        (found,) = world.look("--rule", "slow-simulator", wait="1s")
        assert 0.28 < found.values["ratio"] < 0.39
        assert str(clock.pid) in found.everything


_EAR_OF_ONE = """
import time
import lcmtools
from lcmtools.types.std_msgs import String
lcmtools.init()
node = lcmtools.Node("ear")
node.create_subscription(String, "/chatter", lambda _: time.sleep(0.005), DEPTH)
lcmtools.spin(node)
"""
_FIVE = "data = String().encode(); [bus.publish('/chatter', data) for _ in range(5)]"


def test_a_queue_of_one_for_texts_that_come_five_at_a_time(world):
    ear = world.script(_EAR_OF_ONE.replace("DEPTH", "1"))
    world.until(lambda: ear.pid in world.pids())
    world.sends(_FIVE, 1.5)
    for _ in range(3):
        found = world.finds("queue-drops", "/ear", "/chatter", "dropped-in-bursts")
        assert found.severity == "note"
    world.end(ear)
    ear = world.script(_EAR_OF_ONE.replace("DEPTH", "10"))
    world.until(lambda: ear.pid in world.pids())
    world.is_silent(wait="2s")


def test_a_plain_program_that_dies_while_wtf_listens(world):
    world.hears("A")
    dies = world.sends("bus.publish('A', Twist().encode()) if number < 200 else sys.exit()")
    world.finds("silent", dies.pid, "ended-stream", wait="6s")
