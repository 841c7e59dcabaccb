"""The end of a node's process: clean, soon, and with a goodbye, whatever it is doing."""

import os
import signal
import time
from itertools import cycle
from pathlib import Path

import pytest

from lcmtools.bus.url import parse_url
from lcmtools.graph.protocol import NODE_CHANNEL, decode_announcement
from lcmtools.observe.reading.monitor import BusMonitor

SOON = 1.5
"""[s]: one second, and what a busy computer adds."""


@pytest.fixture
def watch(bus_url):
    with BusMonitor(parse_url(bus_url), "test", os.environ) as watch:
        yield watch


@pytest.fixture
def run(start_python, bus_url):
    """Start a node's script on the test's bus."""

    def start(source, *arguments):
        return start_python(source, *arguments, LCM_DEFAULT_URL=bus_url)

    return start


def _alive(watch):
    return [node for node in watch.settle(foreign=False).nodes if not node.stale]


def _goodbyes(watch, timeout=20.0):
    """The names of the nodes that say goodbye, until one has."""
    deadline = time.monotonic() + timeout
    while time.monotonic() < deadline:
        heard = [p for p in watch.receive(0.05) if p.channel == NODE_CHANNEL]
        announced = [decode_announcement(packet.payload) for packet in heard]
        if names := [a.node.name for a in announced if a and a.leaving]:
            return names
    return []


def _records(bus_url):
    url = parse_url(bus_url)
    folder = Path(os.environ["XDG_RUNTIME_DIR"]) / "lcmtools" / "records"
    return list((folder / f"udpm-{url.host}-{url.port}").glob("*"))


_HEAD = """
import sys, time
import lcmtools
from lcmtools import Node
from lcmtools.types.std_msgs import String
from lcmtools.types.std_srvs import Trigger
lcmtools.init()
"""

_BUSY = {
    "idle": 'node = Node("victim"); print("ready"); lcmtools.spin(node)',
    "publishing": """
node = Node("victim")
publisher = node.create_publisher(String, "chatter")
node.create_timer(0.001, lambda: publisher.publish(String()))
node.create_timer(0.2, lambda: print("ready"))
lcmtools.spin(node)
""",
    "publishing large messages": """
from lcmtools.types.sensor_msgs import Image
node = Node("victim")
publisher = node.create_publisher(Image, "image")
image = Image()
image.data = bytes(1_000_000)
node.create_timer(0.002, lambda: publisher.publish(image))
node.create_timer(0.3, lambda: print("ready"))
lcmtools.spin(node)
""",
    "asleep in a callback": """
node = Node("victim")
node.create_timer(0.01, lambda: (print("ready"), time.sleep(60)))
lcmtools.spin(node)
""",
    "computing in a callback": """
def compute():
    print("ready")
    while True:
        sum(range(1000))
node = Node("victim")
node.create_timer(0.01, compute)
lcmtools.spin(node)
""",
    "calling a service that does not answer": """
node = Node("victim")
client = node.create_client(Trigger, "nobody")
node.create_timer(0.01, lambda: (print("ready"), client.call(Trigger.Request(), timeout=60)))
lcmtools.spin(node)
""",
    "spinning once and again": """
node = Node("victim")
print("ready")
while lcmtools.ok():
    lcmtools.spin_once(node, 0.1)
""",
    "waiting for ever in one spin": """
node = Node("victim")
print("ready")
lcmtools.spin_once(node, None)
""",
    "two nodes": """
nodes = [Node("victim"), Node("other")]
nodes[1].create_timer(0.01, lambda: time.sleep(60))
nodes[0].create_timer(0.2, lambda: None)
print("ready")
lcmtools.spin(*nodes)
""",
    "a context manager": """
with Node("victim") as node:
    print("ready")
    lcmtools.spin(node)
""",
}


@pytest.mark.parametrize(
    ("doing", "number"),
    [("idle", signal.SIGTERM), *zip(_BUSY, cycle((signal.SIGINT, signal.SIGTERM)), strict=False)],
)
def test_a_signal_ends_a_node_soon_with_a_goodbye(run, watch, stopwatch, wait_until, doing, number):
    victim = run(_HEAD + _BUSY[doing] + "\nlcmtools.shutdown()\n")
    victim.wait_for("ready")
    wait_until(lambda: "/victim" in [node.name for node in _alive(watch)])  # one look may be early
    ending = stopwatch(victim.pid)
    victim.send_signal(number)
    assert ending.until_end() < SOON
    code = victim.wait()
    assert code == 0, victim.output
    assert "Traceback" not in victim.output
    assert "Exception" not in victim.output
    assert "/victim" in _goodbyes(watch)
    assert _alive(watch) == []
    assert _records(str(watch.url)) == []


def test_a_node_without_shutdown_says_goodbye_all_the_same(run, watch, bus_url):
    victim = run(_HEAD + 'Node("victim")\nprint("ready")\n')
    assert victim.wait() == 0
    assert _goodbyes(watch) == ["/victim"]
    assert _records(bus_url) == []


def test_a_program_that_fails_says_goodbye_and_shows_why(run, watch, bus_url):
    victim = run(_HEAD + 'node = Node("victim")\n1 / 0\n')
    assert victim.wait() == 1
    assert "ZeroDivisionError" in victim.output
    assert _goodbyes(watch) == ["/victim"]
    assert _records(bus_url) == []


def test_shutdown_in_a_callback_ends_the_program(run, watch):
    victim = run(
        _HEAD + 'node = Node("victim")\nnode.create_timer(0.01, lcmtools.shutdown)\n'
        "lcmtools.spin(node)\nprint('end', lcmtools.ok())\n"
    )
    assert victim.wait() == 0
    assert victim.lines == ["end False"]
    assert _goodbyes(watch) == ["/victim"]


@pytest.mark.timing
def test_a_second_ctrl_c_breaks_a_callback_off_at_once_and_the_goodbye_is_said(
    run, watch, stopwatch
):
    victim = run(_HEAD + _BUSY["asleep in a callback"] + "\nlcmtools.shutdown()\n")
    victim.wait_for("ready")
    ending = stopwatch(victim.pid)
    victim.send_signal(signal.SIGINT)
    time.sleep(0.1)  # nobody presses Ctrl-C twice any faster
    victim.send_signal(signal.SIGINT)
    assert ending.until_end() < 0.45
    assert victim.wait() == 0, victim.output
    assert "Traceback" not in victim.output
    assert _goodbyes(watch) == ["/victim"]


def test_what_a_program_does_after_the_spin_is_not_broken_off(run):
    """To stop a robot takes time, and Ctrl-C is when it is done."""
    victim = run(
        _HEAD + 'node = Node("victim")\nprint("ready")\nlcmtools.spin(node)\n'
        "time.sleep(1.0)\nprint('robot stopped')\nlcmtools.shutdown()\n"
    )
    victim.wait_for("ready")
    victim.send_signal(signal.SIGINT)
    assert victim.wait() == 0, victim.output
    assert victim.lines[-1] == "robot stopped"


def test_two_signals_at_once_do_not_break_off_what_a_program_does_after_the_spin(run):
    """As timeout(1) sends them."""
    victim = run(
        _HEAD + 'import signal\nnode = Node("victim")\n'
        "for _ in range(2):\n    signal.raise_signal(signal.SIGTERM)\n"
        "lcmtools.spin(node)\nprint('robot stopped')\nlcmtools.shutdown()\n"
    )
    assert victim.wait() == 0, victim.output
    assert victim.lines[-1] == "robot stopped"


def test_what_a_program_does_after_its_own_loop_is_not_broken_off(run):
    victim = run(
        _HEAD + 'node = Node("victim")\nprint("ready")\n'
        "while lcmtools.ok():\n    lcmtools.spin_once(node, 0.1)\n"
        "time.sleep(1.0)\nprint('robot stopped')\n"
    )
    victim.wait_for("ready")
    victim.send_signal(signal.SIGINT)
    assert victim.wait() == 0, victim.output
    assert victim.lines[-1] == "robot stopped"


def test_after_shutdown_ctrl_c_is_pythons_own_again(run):
    victim = run(_HEAD + 'lcmtools.shutdown()\nprint("ready")\ntime.sleep(60)\n')
    victim.wait_for("ready")
    victim.send_signal(signal.SIGINT)
    assert victim.wait() != 0
    assert "KeyboardInterrupt" in victim.output


def test_a_signal_that_another_thread_takes_ends_the_node_too(run):
    """It does not interrupt what the main thread waits for; nor does one just before the wait."""
    victim = run(
        _HEAD
        + "import signal, threading\n"
        + 'node = Node("victim")\n'
        + "def end(): signal.pthread_kill(threading.get_ident(), signal.SIGTERM)\n"
        + "threading.Timer(0.3, end).start()\nlcmtools.spin(node)\n"
    )
    assert victim.wait() == 0


def test_signals_may_stay_the_programs_own(run):
    victim = run(
        _HEAD.replace("init()", "init(handle_signals=False)")
        + 'node = Node("victim")\ntry:\n    print("ready")\n    time.sleep(60)\n'
        "except KeyboardInterrupt:\n    print('mine')\n"
    )
    victim.wait_for("ready")
    victim.send_signal(signal.SIGINT)
    assert victim.wait() == 0
    assert victim.lines[-1] == "mine"


def test_a_killed_node_is_known_to_have_ended_until_it_is_forgotten(run, bus_url):
    url = parse_url(bus_url)
    victim = run(_HEAD + _BUSY["idle"])
    victim.wait_for("ready")
    victim.send_signal(signal.SIGKILL)
    victim.wait()
    for _ in range(2):
        with BusMonitor(url, "test", os.environ) as later:
            (node,) = later.settle(foreign=False).nodes
            assert (node.name, node.stale) == ("/victim", "ended without saying goodbye")
            assert node.pid == victim.pid
    with BusMonitor(url, "test", os.environ) as cleaner:
        (node,) = cleaner.settle(foreign=False).nodes
        cleaner.forget(node)
        assert cleaner.graph().nodes == ()
    assert _records(bus_url) == []


def test_a_stopped_node_is_known_to_run_but_not_to_answer(run, bus_url, wait_until):
    victim = run(_HEAD + _BUSY["idle"])
    victim.wait_for("ready")
    victim.send_signal(signal.SIGSTOP)
    wait_until(lambda: _is_stopped(victim.pid))
    with BusMonitor(parse_url(bus_url), "test", os.environ) as later:
        (node,) = later.settle(foreign=False).nodes
        assert node.stale == "runs but does not answer"
        victim.send_signal(signal.SIGCONT)
        (node,) = later.settle(foreign=False).nodes
        assert node.stale == ""


def _is_stopped(pid):
    """Return whether every thread has stopped, which takes a moment after the signal."""
    states = [
        (task / "stat").read_text().rpartition(")")[2].split()[0]
        for task in Path(f"/proc/{pid}/task").iterdir()
    ]
    return set(states) == {"T"}
