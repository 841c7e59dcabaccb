"""Robots stop in time if the server or the page ends or freezes, and only then."""

import itertools
import signal
import threading
import time

import lcm
import pytest

from lcmtools.types.geometry_msgs import Twist
from tests.gui.conftest import panel_address
from tests.gui.test_steer import TOPIC, hold_joystick

_LONG = 40.0  # [s] for what comes
_LIMIT = 0.5  # [s] that a robot goes on if nobody can release it
_FAST = 0.5  # [m/s] by the joystick
_BLOCKS = 8  # times that a page does nothing for longer than the server waits


class Witness:
    """A plain LCM program that hears the commands of speed, on a thread.

    Attributes:
        heard: The time of each command [s], by the monotonic clock, and its speed [m/s].
    """

    def __init__(self, url):
        self.heard = []
        self._changed = threading.Condition()
        self._lcm, self._is_over = lcm.LCM(url), False
        self._lcm.subscribe(TOPIC, self._take)
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def first(self, is_right, since):
        """Wait for the first command since a time with such a speed; return its time."""

        def times():
            return [at for at, speed in self.heard if at > since and is_right(speed)]

        with self._changed:
            assert self._changed.wait_for(times, _LONG), self.heard[-5:]
            return times()[0]

    def close(self):
        """Hear no more."""
        self._is_over = True
        self._thread.join()

    def _run(self):
        while not self._is_over:
            self._lcm.handle_timeout(100)

    def _take(self, _, data):
        with self._changed:
            self.heard.append((time.monotonic(), round(Twist.decode(data).linear.x, 2)))
            self._changed.notify_all()


@pytest.fixture(scope="module", autouse=True)
def _husky(module_start, lcmtools_path):
    module_start(lcmtools_path, "run", "sim", "husky").wait_for("simulating")


@pytest.fixture
def witness(module_bus_url):
    """The messages that a plain LCM program hears."""
    found = Witness(module_bus_url)
    yield found
    found.close()


def _drives(speed):
    return speed == _FAST


def _stops(speed):
    return speed == 0


@pytest.fixture
def held(serve, page, witness):
    """The server of a page that holds the joystick, and drives."""
    server, address = serve("steer", TOPIC)
    page.goto(address)
    hold_joystick(page)
    witness.first(_drives, since=0)
    return server


@pytest.mark.parametrize("number", [signal.SIGSTOP, signal.SIGKILL])
def test_the_robot_is_stopped_that_a_suspended_or_killed_server_drove(held, witness, number):
    held.send_signal(number)
    at = time.monotonic()
    try:
        assert witness.first(_stops, since=at) - at < _LIMIT
    finally:
        held.send_signal(signal.SIGKILL)


@pytest.mark.usefixtures("held")
def test_a_page_that_is_slow_drives_on(page, witness):
    at = time.monotonic()
    for _ in range(_BLOCKS):
        page.evaluate("() => { const end = Date.now() + 400; while (Date.now() < end); }")
        page.wait_for_timeout(120)  # some words to the worker that sends
    speeds = [speed for time, speed in witness.heard if time > at]
    page.mouse.up()
    stops = sum(a != 0 and b == 0 for a, b in itertools.pairwise(speeds))
    assert (
        stops < _BLOCKS / 2
    )  # one in each if the page itself sent; a busy computer may cause some
    witness.first(_stops, since=at)


@pytest.mark.usefixtures("held")
def test_a_page_that_is_frozen_stops_and_drives_on_when_it_is_back(page, witness):
    at = time.monotonic()
    page.evaluate("() => { const end = Date.now() + 2000; while (Date.now() < end); }")
    back = time.monotonic()
    assert witness.first(_stops, since=at) < at + 2 * _LIMIT
    assert not [speed for time, speed in witness.heard if at + 2 * _LIMIT < time < back - 0.1]
    witness.first(_drives, since=back)
    page.mouse.up()
    witness.first(_stops, since=back)


def test_closing_the_panel_stops(serve, page, witness):
    page.goto(panel_address(serve()[1], "steer", topic=TOPIC))
    hold_joystick(page)
    witness.first(_drives, since=0)
    at = time.monotonic()
    page.evaluate("() => document.querySelector('[aria-label^=Close]').click()")
    witness.first(_stops, since=at)
