"""A robot stands within half a second, whatever befalls the pages, the server or its process."""

import os
import signal
import threading
import time
from contextlib import suppress
from pathlib import Path

import lcm
import pytest
from fixtures.window import LivePage

from lcmtools.bus.url import parse_url
from lcmtools.gui.dead_man import HOLD, Command
from lcmtools.gui.steering_process import NoAnswer, SteeringProcess
from lcmtools.messages.codec import encode
from lcmtools.types.geometry_msgs import Twist

pytestmark = pytest.mark.timing
TOPIC, TWIST, STAMPED = "/robot/cmd_vel", "geometry_msgs/Twist", "geometry_msgs/TwistStamped"
_LIMIT = 0.5  # [s]
_LONG = 40.0  # [s] for what comes


class Robot:
    """A plain LCM program without a timeout: its speed is that of the last Twist."""

    def __init__(self, url):
        self.speed, self.since = 0.0, 0.0
        self._changed = threading.Condition()
        self._lcm, self._is_over = lcm.LCM(url), False
        self._lcm.subscribe(TOPIC, self._take)
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def wait(self, *, moves):
        """Wait until it moves, or stands; return the time when it began to [s, monotonic]."""
        with self._changed:
            assert self._changed.wait_for(lambda: bool(self.speed) is moves, _LONG), self.speed
            return self.since

    def close(self):
        """Leave the bus."""
        self._is_over = True
        self._thread.join()

    def _run(self):
        while not self._is_over:
            self._lcm.handle_timeout(100)

    def _take(self, _, data):
        with suppress(ValueError), self._changed:  # of another type
            speed = Twist.decode(data).linear.x
            if bool(speed) is not bool(self.speed):
                self.since = time.monotonic()
            self.speed = speed
            self._changed.notify_all()


@pytest.fixture
def robot(bus_url):
    """A robot on the test's bus."""
    made = Robot(bus_url)
    yield made
    made.close()


@pytest.fixture
def window(start, lcmtools_path, bus_url):
    """The process of a server."""
    return start(lcmtools_path, "gui", "--port", "0", "--no-open", LCM_DEFAULT_URL=bus_url)


@pytest.fixture
def address(window):
    """Its address."""
    return window.wait_for("http://").split()[-1]


class Driver:
    """A page that holds the joystick: it repeats its command every 0.1 s until it is ended."""

    def __init__(self, address, kind=TWIST):
        self.page, self._kind = LivePage(address), kind
        self.page.open(1, "steer", topic=TOPIC)
        self._is_over = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def end(self, op=""):
        """Let go, or say nothing more."""
        self._is_over.set()
        self._thread.join()
        if op:
            self.page.send(op=op, id=1, topic=TOPIC, type=self._kind, sent=time.monotonic())

    def _run(self):
        values = {"topic": TOPIC, "type": self._kind, "forward": 0.5, "turn": 0.0}
        while not self._is_over.wait(0.1):
            with suppress(Exception):  # the server is gone
                self.page.send(op="drive", id=1, sent=time.monotonic(), **values)


@pytest.fixture
def driver(address, robot):
    """A page that drives the robot."""
    made = Driver(address)
    robot.wait(moves=True)
    yield made
    made.end()


def steering_pid(window):
    """The process that publishes for a server."""
    children = Path(f"/proc/{window.pid}/task/{window.pid}/children").read_text().split()
    (found,) = [
        one for one in children if b"steering_process" in Path(f"/proc/{one}/cmdline").read_bytes()
    ]
    return int(found)


@pytest.mark.parametrize("op", ["release", "stop", ""])
def test_a_page_that_lets_go_stops_or_falls_silent(driver, robot, op):
    driver.end(op)
    at = time.monotonic()
    assert robot.wait(moves=False) - at < _LIMIT


@pytest.mark.parametrize("op", ["release", "stop", ""])
def test_the_stop_has_the_type_that_drives_whatever_another_page_says(driver, robot, address, op):
    other = Driver(address, STAMPED)
    other.page.until(lambda frame: frame.get("data", {}).get("refused"))
    (other if op == "stop" else driver).end(op)
    at = time.monotonic()
    assert robot.wait(moves=False) - at < _LIMIT
    other.end()


@pytest.mark.parametrize("number", [signal.SIGSTOP, signal.SIGKILL, signal.SIGTERM])
@pytest.mark.usefixtures("driver")
def test_the_server_is_stopped_killed_or_ended(window, robot, number):
    window.send_signal(number)
    at = time.monotonic()
    try:
        assert robot.wait(moves=False) - at < _LIMIT
    finally:
        window.send_signal(signal.SIGKILL)


@pytest.mark.parametrize("number", [signal.SIGSTOP, signal.SIGKILL])
@pytest.mark.parametrize("op", ["release", "stop"])
def test_the_process_that_publishes_is_stopped_or_killed(window, driver, robot, number, op):
    os.kill(steering_pid(window), number)
    driver.end(op)
    at = time.monotonic()
    assert robot.wait(moves=False) - at < _LIMIT


def test_a_process_that_stops_at_its_first_command_is_not_awaited_as_at_its_start(
    bus_url, monkeypatch
):
    ask, stopped_at = SteeringProcess._ask, []

    def stopped(self, command):
        if command.op == "drive":
            os.kill(self.pid, signal.SIGSTOP)
            stopped_at.append(time.monotonic())
        return ask(self, command)

    monkeypatch.setattr(SteeringProcess, "_ask", stopped)
    process, stop = SteeringProcess(parse_url(bus_url)), encode(Twist())
    command = Command("drive", 1, TOPIC, (TWIST, 0), stop, stop, time.monotonic() + _LONG)
    with pytest.raises(NoAnswer):
        process.execute(command)
    assert time.monotonic() - stopped_at[0] < _LIMIT
    process.kill()


def test_a_process_that_is_replaced_drives_on(window, driver, robot):
    os.kill(steering_pid(window), signal.SIGKILL)
    robot.wait(moves=False)
    robot.wait(moves=True)
    driver.end("release")
    robot.wait(moves=False)


def test_a_command_that_comes_late_is_valid_from_when_it_was_sent(driver, robot):
    driver.end()
    robot.wait(moves=False)
    sent = time.monotonic() - HOLD / 2
    values = {"topic": TOPIC, "type": TWIST, "forward": 0.5, "turn": 0.0}
    driver.page.send(op="drive", id=1, sent=sent, **values)
    robot.wait(moves=True)
    assert robot.wait(moves=False) - sent < _LIMIT


def test_a_line_that_no_pipe_takes_whole_stops_the_robot(bus_url, robot):
    """The server may be killed in the middle of it."""
    drive = Twist()
    drive.linear.x = 0.5
    kind = TWIST, int.from_bytes(encode(drive)[:8], "big")
    stop = encode(Twist())
    command = Command("drive", 1, TOPIC, kind, encode(drive), stop, time.monotonic() + _LONG)
    process = SteeringProcess(parse_url(bus_url))
    assert process.execute(command) == ""
    robot.wait(moves=True)
    long = command._replace(topic="/other", stop=bytes(1 << 16))
    assert process.execute(long) == ""
    process._socket.send(long.line()[:50_000])
    process.close()
    robot.wait(moves=False)
