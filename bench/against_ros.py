"""The command line beside rostopic, rosnode and roswtf, the models for it, in one run.

They come from Debian's packages (python3-rostopic, python3-rosnode, python3-roswtf,
python3-roslaunch, python3-rosmaster and python3-geometry-msgs); where they are not installed, one
line says so, and the exit code is 0. Each side looks at a system of its own, in a network
namespace: a ROS master with, or an LCM bus with, a node that publishes ten topics at 10 Hz, and
one that listens to them all.

Commands that end run in turn, round after round: medians of wall and processor time (the master's
is not counted). Commands that go on are watched once they run smoothly: ``echo`` prints messages
into a file, from a topic of so many a second, "flat out" from one with more than anybody can print;
"us" is processor time for one message. ROS sends by TCP, which holds the publisher back; over LCM
what cannot be taken is lost. In ``hz``, "off by" is how far the rate told is from the true one; our
command sees all of the bus, the ten topics too. ``info`` measures rates for half a second, which
rostopic does not. "failed" counts exit codes other than 0: rostopic -h has one. A ratio is ROS's
figure by ours (for messages a second ours by ROS's): above 1, ours is better.
"""

import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from multiprocessing.connection import Connection

from commands import TOOL, Environment, child_environment, in_turn, run, running, watch
from common import Child, bus, child, every, isolate, rounds_asked, show
from compared import ENDED, FLOWING, RATES, ended_cells, flow_cells, rate_cells

import lcmtools
from lcmtools.types.geometry_msgs import Twist

_PORT = 7789
_MASTER = "http://127.0.0.1:11311"
_NEEDED = ("rostopic", "rosnode", "roswtf", "roscore", "rosmaster")
_PYTHON = "/usr/bin/python3"  # the one that Debian's packages are for
_TOPICS = 10
_SECONDS = 2.0  # that a command which goes on is watched
_STEADY = 500.0  # [Hz]
_FLAT_OUT = 20_000.0  # [Hz], more than any of them prints
_BURST = 0.002  # [s] between the bursts of a stream that is faster

_ROS_NODE = """
import sys, time, rospy
from geometry_msgs.msg import Twist
name, rate = sys.argv[1], float(sys.argv[2])
rospy.init_node(name)
topics = ["/topic_%d" % number for number in range(10)]
message = Twist()
message.linear.x, message.angular.z = 0.5, 0.3
if name == "hearer":
    ears = [rospy.Subscriber(topic, Twist, lambda _: None) for topic in topics]
    rospy.spin()
names = topics if name == "speaker" else ["/stream"]
publishers = [rospy.Publisher(topic, Twist, queue_size=None) for topic in names]
burst = max(1, round(rate * 0.002))
start, sent = time.monotonic(), 0
while not rospy.is_shutdown():
    for _ in range(burst):
        for publisher in publishers:
            publisher.publish(message)
    sent += burst
    time.sleep(max(0.0, start + sent / rate - time.monotonic()))
"""


def speak(connection: Connection) -> None:
    """Child: a node that publishes ten topics at 10 Hz."""
    lcmtools.init([], url=bus(_PORT))
    node = lcmtools.Node("speaker")
    publishers = [node.create_publisher(Twist, f"/topic_{n}") for n in range(_TOPICS)]

    def publish_all() -> None:
        for publisher in publishers:
            publisher.publish(message())

    node.create_timer(0.1, publish_all)
    connection.send(None)
    lcmtools.spin(node)
    lcmtools.shutdown()


def hear(connection: Connection) -> None:
    """Child: a node that listens to them."""
    lcmtools.init([], url=bus(_PORT))
    node = lcmtools.Node("hearer")
    for number in range(_TOPICS):
        node.create_subscription(Twist, f"/topic_{number}", lambda _: None)
    connection.send(None)
    lcmtools.spin(node)
    lcmtools.shutdown()


def stream(connection: Connection, rate: float) -> None:
    """Child: a node that publishes one topic at a rate [Hz], in bursts where that is high."""
    lcmtools.init([], url=bus(_PORT))
    publisher = lcmtools.Node("streamer").create_publisher(Twist, "/stream")
    sent, burst = message(), max(1, round(rate * _BURST))
    connection.send(None)
    with suppress(KeyboardInterrupt):  # which SIGTERM is, for a node
        for _ in every(burst / rate, 3600.0):
            for _ in range(burst):
                publisher.publish(sent)
    lcmtools.shutdown()


def message() -> Twist:
    """The messages that are sent."""
    twist = Twist()
    twist.linear.x, twist.angular.z = 0.5, 0.3
    return twist


def ros_environment(cache: str) -> dict[str, str]:
    """The environment variables of a ROS system of one's own, with a folder for its files."""
    return {
        "ROS_MASTER_URI": _MASTER,
        "ROS_IP": "127.0.0.1",
        "ROS_LOG_DIR": cache,
        "ROS_HOME": cache,
    }


def missing(programs: Sequence[str]) -> list[str]:
    """Return those of these programs that are not installed, and Python's packages for nodes."""
    found = [name for name in programs if shutil.which(name, path="/usr/bin") is None]
    for name in ("rospy", "geometry_msgs.msg"):
        command = [_PYTHON, "-c", f"import {name}"]
        if subprocess.run(command, capture_output=True, check=False).returncode:
            found.append(name.partition(".")[0])
    return found


def ros_node(name: str, rate: float) -> list[str]:
    """The command of a ROS node."""
    return [_PYTHON, "-c", _ROS_NODE, name, f"{rate}"]


@contextmanager
def streaming(environment: Environment, rate: float) -> Iterator[None]:
    """The same stream on both sides, while the block runs."""
    with child(stream, rate) as streamer, running([ros_node("streamer", rate)], environment):
        streamer.wait()
        yield


def ended(environment: Environment, rounds: int) -> list[list[object]]:
    """The table of commands that end."""
    pairs = {
        "--help": (["--help"], ["rostopic", "-h"]),
        "list": (["list"], ["rostopic", "list"]),
        "list -v": (["list", "-v"], ["rostopic", "list", "-v"]),
        "info": (["info", "/topic_1"], ["rostopic", "info", "/topic_1"]),
        "type": (["type", "/topic_1"], ["rostopic", "type", "/topic_1"]),
        "echo -n 1": (["echo", "-n", "1", "/topic_1"], ["rostopic", "echo", "-n", "1", "/topic_1"]),
        "node list": (["node", "list"], ["rosnode", "list"]),
        "node info": (["node", "info", "/speaker"], ["rosnode", "info", "/speaker"]),
        "wtf": (["wtf"], ["roswtf"]),
    }
    rows = []
    for label, (ours, (program, *arguments)) in pairs.items():
        theirs = [f"/usr/bin/{program}", *arguments]
        sides = {
            "ours": partial(run, [TOOL, *ours], environment),
            "theirs": partial(run, theirs, environment),
        }
        found = in_turn(sides, rounds)
        rows.append([label, *ended_cells(found["ours"], found["theirs"], r"/topic_\d")])
    return rows


def echoed(environment: Environment, rounds: int, seconds: float) -> list[list[object]]:
    """The table of echo."""
    rows = []
    for rate, speed in ((_STEADY, f"{_STEADY:g} Hz"), (_FLAT_OUT, "flat out")):
        with streaming(environment, rate):
            sides = {
                program: partial(watch, [program, "echo", "/stream"], environment, "^---$", seconds)
                for program in (TOOL, "/usr/bin/rostopic")
            }
            rows.append([f"Twist, {speed}", *flow_cells(*in_turn(sides, rounds).values())])
    return rows


def measured(environment: Environment, rounds: int, seconds: float) -> list[list[object]]:
    """The table of hz."""
    at_once = {**environment, "PYTHONUNBUFFERED": "1"}  # else rostopic keeps what it prints
    rows = []
    for rate in (100.0, 1000.0):
        with streaming(environment, rate):
            mark = r"average rate: ([\d.]+)"
            sides = {
                program: partial(watch, [program, "hz", "/stream"], at_once, mark, seconds)
                for program in (TOOL, "/usr/bin/rostopic")
            }
            ours, theirs = in_turn(sides, rounds).values()
            rows.append([f"{rate:g} Hz", *rate_cells(rate, (ours, theirs), (mark, mark))])
    return rows


def compare(rounds: int, seconds: float) -> None:
    """Measure and print all tables."""
    with tempfile.TemporaryDirectory() as cache:
        environment = {**child_environment(cache, _PORT), **ros_environment(cache)}
        with running([["/usr/bin/roscore"]], environment), _lcm_system():
            time.sleep(3.0)  # until the master answers
            with running([ros_node("speaker", 10.0), ros_node("hearer", 0.0)], environment):
                both = "lcmtools and the ROS tools"
                title = f"Commands that end, {both}, medians of {rounds} runs"
                show(title, ENDED, ended(environment, rounds))
                few = min(rounds, 3)
                title = f"{both}, medians of {few} times {seconds:g} s"
                show(f"echo, {title}", FLOWING, echoed(environment, few, seconds))
                show(f"hz, {title}", RATES, measured(environment, few, seconds))


@contextmanager
def _lcm_system() -> Iterator[list[Child]]:
    """The nodes on the LCM bus, while the block runs."""
    with child(speak) as speaker, child(hear) as hearer:
        speaker.wait()
        hearer.wait()
        yield [speaker, hearer]


def main() -> None:
    """Measure and print."""
    rounds = rounds_asked(__doc__, 11)
    if absent := missing(_NEEDED):
        print(f"nothing to compare with: {', '.join(absent)} not installed (Debian's packages)")
        return
    isolate()
    compare(rounds, _SECONDS)


if __name__ == "__main__":
    main()
