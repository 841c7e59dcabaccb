"""pub waits for those who are to hear, keeps its pace, and stamps what it sends."""

import json
import subprocess
import time
from collections.abc import Callable
from itertools import count
from typing import Any

import pytest

Run = Callable[..., subprocess.CompletedProcess[str]]
STRING = "std_msgs/String"

pytestmark = pytest.mark.usefixtures("use_module_bus")
_topics = count()


@pytest.fixture
def topic() -> str:
    """A topic of the test's own."""
    return f"/waits{next(_topics)}"


def published(result: subprocess.CompletedProcess[str]) -> list[Any]:
    """The messages that pub -v says it has sent."""
    rows = [row.partition(": ") for row in result.stderr.splitlines()]
    return [json.loads(rest) for head, _, rest in rows if head.startswith("publishing #")]


def test_as_many_subscribers_as_asked_are_waited_for(
    topic: str, start: Callable[..., Any], lcmtools_path: str
) -> None:
    pub = start(lcmtools_path, "pub", "-1", "-w", "2", topic, STRING, "x")
    pub.wait_for(f"lcmtools pub: waiting for 2 subscribers of {topic}; 0 so far")
    echoes = [start(lcmtools_path, "echo", topic) for _ in range(2)]
    for echo in echoes:
        echo.wait_for("data:")
    assert pub.wait() == 0


@pytest.mark.parametrize("words", [["-w", "1"], ["-1"], ["-t", "2"], ["-r", "5", "-w", "1"]])
def test_subscribers_that_do_not_come_in_time_are_exit_code_4(
    words: list[str], topic: str, lcmtools: Run
) -> None:
    result = lcmtools("pub", *words, "--timeout", "300ms", topic, STRING, "x")
    assert (result.returncode, result.stdout) == (4, "")
    assert result.stderr == (
        f"lcmtools pub: not within 0.3 s: 1 subscriber of {topic}; 0 so far;"
        f" lcmtools info {topic} shows who is there\n"
    )


_PLAIN_LISTENER = """
import lcm
bus = lcm.LCM()
bus.subscribe("PLAIN", lambda channel, payload: print("heard", flush=True))
print("ready", flush=True)
while True:
    bus.handle()
"""


def test_plain_lcm_programs_are_not_waited_for(
    start: Callable[..., Any],
    start_python: Callable[..., Any],
    stopwatch: Callable[[int], Any],
    bus_url: str,
    lcmtools_path: str,
) -> None:
    def publish() -> tuple[float, int, str]:
        words = ("pub", "-1", "--literal", "PLAIN", STRING, "x")
        pub = start(lcmtools_path, *words, LCM_DEFAULT_URL=bus_url)
        return stopwatch(pub.pid).until_end(), pub.wait(), pub.output

    alone, _, said = publish()
    assert said.startswith("lcmtools pub: no node subscribes to PLAIN yet")

    plain = start_python(_PLAIN_LISTENER, LCM_DEFAULT_URL=bus_url)
    plain.wait_for("ready")
    heard, code, said = publish()
    assert (code, said) == (0, "")
    plain.wait_for("heard")
    assert heard < alone  # seconds; most of a second of waiting is spared


def test_times_end_after_so_many(topic: str, lcmtools: Run) -> None:
    started = time.monotonic()
    result = lcmtools("pub", "-v", "-w", "0", "-t", "3", "-r", "4", topic, STRING, "x")
    assert (result.returncode, result.stdout) == (0, "")
    assert published(result) == [{"data": "x"}] * 3
    assert time.monotonic() - started > 0.5  # seconds: two periods


def test_each_message_is_stamped_when_it_is_sent(topic: str, lcmtools: Run) -> None:
    before = time.time_ns()
    words = ["geometry_msgs/PoseStamped", "{header: auto, pose: {position: {x: 1}}}"]
    result = lcmtools("pub", "-v", "-w", "0", "-s", "-t", "3", "-r", "20", topic, *words)
    stamps = [message["header"]["stamp"] for message in published(result)]
    times = [stamp["sec"] * 1_000_000_000 + stamp["nsec"] for stamp in stamps]
    assert before < times[0] < times[1] < times[2] < time.time_ns()
    assert times[2] - times[0] > 50_000_000  # nanoseconds


def test_stamps_may_be_simulated_time(
    topic: str, start: Callable[..., Any], bus_url: str, lcmtools: Run, lcmtools_path: str
) -> None:
    clock = start(
        lcmtools_path,
        *("pub", "-r", "50", "/clock", "rosgraph_msgs/Clock", "{clock: [12, 34]}"),
        LCM_DEFAULT_URL=bus_url,
    )
    result = lcmtools(
        *("pub", "-1", "-v", "-w", "0", "--use-rostime", topic, "std_msgs/Header", "stamp: now"),
        LCM_DEFAULT_URL=bus_url,
    )
    assert published(result) == [{"seq": 0, "stamp": {"sec": 12, "nsec": 34}, "frame_id": ""}]
    clock.end()
    result = lcmtools(
        *("pub", "-1", "--use-rostime", "--timeout", "300ms", topic, "std_msgs/Header", "auto"),
        LCM_DEFAULT_URL=bus_url,
    )
    assert (result.returncode, result.stderr) == (
        4,
        "lcmtools pub: nothing came on /clock within 0.3 s; is the simulator running?\n",
    )


def test_keep_alive_serves_who_comes_late(
    topic: str, start: Callable[..., Any], lcmtools: Run, lcmtools_path: str
) -> None:
    pub = start(
        lcmtools_path,
        *("pub", "-1", "-v", "-w", "0", "--keep-alive", "8s", topic, STRING, "stay"),
    )
    pub.wait_for("publishing #1")
    assert lcmtools("echo", "-1", "--timeout", "5s", topic).stdout == 'data: "stay"\n---\n'
    assert pub.wait() == 0
    assert "publishing #1 again, to who has just subscribed" in pub.lines


def test_latch_and_rate_go_together(
    topic: str, start: Callable[..., Any], lcmtools: Run, lcmtools_path: str
) -> None:
    pub = start(
        lcmtools_path, "pub", "-l", "-v", "-r", "0.05", "-w", "0", topic, STRING, "data: slow"
    )
    pub.wait_for("publishing #1")
    assert lcmtools("echo", "-1", "--timeout", "5s", topic).stdout == 'data: "slow"\n---\n'


_COUNTER = """
import sys, time
import lcm
bus = lcm.LCM()
times = []
bus.subscribe(sys.argv[1], lambda channel, payload: times.append(time.monotonic()))
print("ready", flush=True)
while len(times) < int(sys.argv[2]):
    bus.handle()
print("rate", (len(times) - 1) / (times[-1] - times[0]), flush=True)
"""


@pytest.mark.usefixtures("private_network")
def test_a_thousand_messages_a_second_are_kept_without_drift(
    topic: str, start: Callable[..., Any], start_python: Callable[..., Any], lcmtools_path: str
) -> None:
    counter = start_python(_COUNTER, topic, "1500")
    counter.wait_for("ready")
    start(lcmtools_path, "pub", "-r", "1000", topic, "std_msgs/Header", "auto")
    rate = float(counter.wait_for("rate").split()[1])
    assert rate == pytest.approx(1000, rel=0.05)
