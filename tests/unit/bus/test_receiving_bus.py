"""The receiving half of a bus, whatever its messages come through: tested on one of two pipes."""

import os
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import pytest
from fixtures.says import raises_saying

from lcmtools.bus import receive_right
from lcmtools.bus.receive_right import ReceiveRight
from lcmtools.bus.receiving_bus import ReceivingBus
from lcmtools.bus.url import parse_url
from lcmtools.bus.wakeup import WakeupEvent
from lcmtools.errors import BusError

_LONG = 20.0  # [s]


class PipeBus(ReceivingBus):
    """Each byte in one of its pipes is a message on channel "a"."""

    def __init__(self):
        super().__init__(parse_url("memq://"))
        self.threads = []
        self.ends = [os.pipe(), os.pipe()]
        self._subscribe("a", lambda _payload, _time: self.threads.append(threading.get_ident()))
        self._start()

    def send(self, messages, pipe=0):
        """Let messages arrive."""
        os.write(self.ends[pipe][1], bytes(messages))

    def on_receiver(self, work):
        """Run ``work`` on the receiving thread."""
        self._on_receiver(work)

    def _begin(self, channel):
        assert channel == "a"

    def _end(self, channel):
        raise AssertionError(channel)

    def _descriptors(self):
        return [read for read, _ in self.ends]

    def _receive(self, most):
        count = 0
        for read, _ in self.ends:
            os.set_blocking(read, False)
            try:
                count += len(os.read(read, most - count)) if most > count else 0
            except BlockingIOError:
                continue
        for _ in range(count):
            self._dispatch("a", b"x", 0)
        return count

    def _leave(self):
        for end in self.ends:
            for descriptor in end:
                os.close(descriptor)
        self.ends = []


@pytest.fixture
def bus(monkeypatch):
    """A bus whose own thread does not receive for a thread that is away."""
    monkeypatch.setattr(receive_right, "_PATIENCE", 3600.0)
    bus = PipeBus()
    yield bus
    bus.close()


@pytest.fixture
def never():
    """An event that is not set."""
    event = WakeupEvent()
    yield event
    event.close()


@pytest.mark.parametrize("pipe", [0, 1])
def test_each_descriptor_wakes_the_thread_that_waits(bus, never, pipe):
    bus.wait(never, 0.0)
    bus.send(1, pipe)
    bus.wait(never, _LONG)
    assert bus.threads == [threading.get_ident()]


def test_its_own_thread_receives_until_another_waits():
    bus, received = PipeBus(), WakeupEvent()
    bus.on_received = received.set
    bus.send(3)
    received.wait(_LONG)
    bus.close()
    received.close()
    assert len(bus.threads) == 3
    assert threading.get_ident() not in bus.threads


def test_few_messages_of_a_burst_are_handled_at_a_time_but_not_of_one_without_end(bus, never):
    bus.wait(never, 0.0)
    bus.send(200)
    handled = []
    while sum(handled) < 200:
        before = len(bus.threads)
        bus.wait(never, _LONG)
        handled.append(len(bus.threads) - before)
    assert handled == [*[10] * 10, 100]


class Gate:
    """A handler that holds its thread until it is let go, once."""

    def __init__(self, bus):
        self.is_entered, self._is_open = threading.Event(), threading.Event()
        bus._handlers[b"a"] = (*bus._handlers[b"a"], self._hold)

    def open(self):
        """Let the thread go."""
        self._is_open.set()

    def _hold(self, _payload, _time):
        self.is_entered.set()
        assert self._is_open.wait(_LONG)


@pytest.mark.parametrize("is_leading", [False, True])
def test_a_thread_is_not_stuck_if_another_waits_while_it_takes_the_right_or_has_it(
    bus, never, wait_until, *, is_leading
):
    gate, event, right = Gate(bus), WakeupEvent(), bus._right
    if is_leading:
        bus.wait(never, 0.0)
    bus.send(1)
    with ThreadPoolExecutor() as pool:
        assert is_leading or gate.is_entered.wait(_LONG)  # on the bus's own thread
        first = pool.submit(bus.wait, event, _LONG)
        assert gate.is_entered.wait(_LONG)
        wait_until(lambda: right.leader)
        bus.wait(never, 0.0)
        # if it sleeps by now, the one that leads must wake it as it ends
        wait_until(lambda: not is_leading or right._alarm.locked())
        gate.open()
        event.set()
        first.result(_LONG / 2)
    event.close()
    bus.send(1)
    wait_until(lambda: len(bus.threads) == 2)
    assert bus.threads[1] == right.own


def test_a_request_is_served_once_while_a_thread_waits(bus, never):
    bus.wait(never, 0.0)
    served = []
    with ThreadPoolExecutor(1) as threads:
        request = threads.submit(bus.on_receiver, lambda: served.append(threading.get_ident()))
        deadline = time.monotonic() + _LONG
        while not request.done() and time.monotonic() < deadline:
            bus.wait(never, 0.1)
        request.result(0)
    assert len(served) == 1


def test_an_error_of_a_request_is_raised_where_it_was_made(bus):
    def fail():
        raise BusError("no such channel")

    with pytest.raises(BusError, match="no such channel"):
        bus.on_receiver(fail)


def test_an_event_ends_a_wait_and_is_cleared(bus, never):
    never.set()
    bus.wait(never, _LONG)
    assert not never.is_set


def test_a_closed_bus_refuses_requests_and_waits_for_events_only(never):
    bus = PipeBus()
    bus.close()
    bus.close()
    with pytest.raises(BusError, match="the bus is closed"):
        bus.on_receiver(lambda: None)
    bus.wait(never, 0.0)
    assert bus.threads == []


def test_a_bus_of_a_parent_refuses_requests():
    bus = PipeBus()
    bus.leave_to_parent()
    with raises_saying(BusError, "bus", "parent process"):
        bus.on_receiver(lambda: None)


def test_a_signal_handler_may_close_the_bus_while_it_receives(bus, never, monkeypatch):
    def interrupted(_most):
        (descriptor, _), _ = bus.ends
        bus.close()
        return len(os.read(descriptor, 1))

    bus.wait(never, 0.0)  # the thread that waits receives from now on
    monkeypatch.setattr(bus, "_receive", interrupted)
    bus.send(1)
    bus.wait(never, _LONG)
    assert bus.ends == []


def _fails(_payload, _time):
    raise BrokenPipeError(32, "Broken pipe")


@pytest.mark.parametrize("waits", [True, False])
def test_an_exception_of_a_handler_costs_it_one_message_and_is_reported_once(
    bus, never, wait_until, *, waits
):
    reports = []
    handled = []
    bus.on_outage = reports.append
    bus._handlers[b"a"] = (_fails, lambda _payload, _time: handled.append(1))
    for _ in range(3):
        bus.send(2)
        if waits:
            bus.wait(never, 0.1)
    wait_until(lambda: len(handled) == 6)
    assert reports == ["receiving from a failed: BrokenPipeError: [Errno 32] Broken pipe"]


def test_a_report_may_fail_too(bus, wait_until):
    def report(_text):
        raise ValueError("I/O operation on closed file")

    bus.on_outage = report
    bus._handlers[b"a"] = (_fails, *bus._handlers[b"a"])
    bus.send(1)
    wait_until(lambda: bus.threads)
    bus.send(1)
    wait_until(lambda: len(bus.threads) == 2)
    assert bus._thread.is_alive()


def test_its_own_thread_outlives_a_fault_of_the_system(bus, wait_until, monkeypatch):
    reports = []
    bus.on_outage = reports.append
    receive, faults = bus._receive, [OSError(12, "Cannot allocate memory"), MemoryError()]

    def once(most):
        if faults:
            raise faults.pop()
        return receive(most)

    monkeypatch.setattr(bus, "_receive", once)
    bus.send(1)
    wait_until(lambda: bus.threads)
    assert len(reports) == 2


def test_a_leader_that_has_just_gone_is_waited_for_though_an_earlier_turn_wakes():
    right, looks = receive_right.ReceiveRight(is_lendable=True), []
    right.turns = 1

    def has_work():
        looks.append(right.is_away)
        right.wake_own()
        return len(looks) == 3

    right.follow(has_work)
    right.close()
    assert looks == [True] * 3


@pytest.mark.parametrize(
    ("is_pressing", "found_away", "naps"),
    [
        (False, [False] * 6, [1, 2, 4, 8, 8, 8]),  # short callbacks
        (False, [False, False, True, False, False], [1, 2, 4, 1, 2]),  # once in a long one
        (True, [False] * 4, [1, 1, 1, 1]),  # large messages
    ],
)
def test_looks_for_a_leader_that_comes_and_goes_are_seldom_if_callbacks_and_messages_are_short(
    monkeypatch, is_pressing, found_away, naps
):
    monkeypatch.setattr(receive_right, "_PATIENCE", 1)
    right, asleep = ReceiveRight(is_lendable=True), []

    class Alarm:
        def acquire(self, timeout):
            asleep.append(timeout)
            right.turns += 1
            right.is_away = found_away[len(asleep) - 1]
            right.is_closed = len(asleep) == len(found_away)
            return False

    right.is_away, right.turns, right.is_pressing = False, 1, is_pressing
    right._alarm = Alarm()
    right.follow(lambda: False)
    assert asleep == naps
    right.wakeup.close()
