"""Receiving on the thread that waits for messages, and on the bus's own while that one is away."""

import signal
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

import lcmtools
from lcmtools.bus import receive_right, udp_bus
from lcmtools.bus.kernel import IS_LINUX
from lcmtools.bus.url import parse_url
from lcmtools.bus.wakeup import WakeupEvent
from lcmtools.types.std_msgs import String
from lcmtools.types.std_srvs import Trigger

_LONG = 20.0  # [s]


@pytest.fixture
def endless_patience(monkeypatch):
    """The bus's own thread does not receive by itself for a thread that is away."""
    monkeypatch.setattr(receive_right, "_PATIENCE", 3600.0)


@pytest.fixture
def never():
    """An event that is not set until the test ends."""
    event = WakeupEvent()
    yield event
    event.close()


class Receivers:
    """The threads on which a channel's messages were handled."""

    def __init__(self, bus, channel="a"):
        self.threads = []
        bus.subscribe(channel, lambda _payload, _time: self.threads.append(threading.get_ident()))

    def wait(self, bus, event, messages=1):
        """Wait on the bus until messages have come."""
        bus.on_received = event.set  # the bus's own thread may have handled them
        deadline = time.monotonic() + _LONG
        while len(self.threads) < messages and time.monotonic() < deadline:
            bus.wait(event, deadline - time.monotonic())
        assert len(self.threads) >= messages


@pytest.mark.usefixtures("endless_patience")
def test_messages_are_handled_on_the_thread_that_waits(bus, other, never):
    receivers = Receivers(bus)
    bus.wait(never, 0.0)
    for count in range(1, 4):
        other.publish("a", b"x")
        receivers.wait(bus, never, count)
    assert set(receivers.threads) == {threading.get_ident()}


def test_a_thread_that_stays_away_is_replaced(bus, other, never, wait_until):
    receivers = Receivers(bus)
    bus.wait(never, 0.0)
    for count in range(1, 4):  # it takes over once, and then receives each
        other.publish("a", b"x")
        wait_until(lambda count=count: len(receivers.threads) == count)
    assert threading.get_ident() not in receivers.threads
    bus.wait(never, 0.0)
    other.publish("a", b"x")
    receivers.wait(bus, never, 4)


@pytest.mark.usefixtures("endless_patience")
def test_a_thread_that_hands_over_is_replaced_at_once(bus, other, never, wait_until):
    receivers = Receivers(bus)
    bus.wait(never, 0.0)
    bus.hand_over()
    other.publish("a", b"x")
    wait_until(lambda: receivers.threads)
    assert receivers.threads[0] != threading.get_ident()


@pytest.mark.usefixtures("endless_patience")
def test_subscriptions_are_made_while_a_thread_waits_and_while_it_is_away(bus, other, never):
    with ThreadPoolExecutor(1) as threads:
        waiting = Waiting(bus, threads)
        Receivers(bus, "other")
        waiting.end()
    receivers = Receivers(bus)  # it has gone
    other.publish("a", b"x")
    receivers.wait(bus, never)


@pytest.mark.usefixtures("endless_patience")
def test_requests_at_any_moment_are_served(bus, other, never):
    """Also at the very moment at which the waiting thread comes, or leaves."""
    receivers = Receivers(bus)
    done = threading.Event()

    def come_and_go():
        for number in range(300):
            Receivers(bus, f"channel{number}")
        done.set()
        other.publish("a", b"x")

    with ThreadPoolExecutor(1) as threads:
        requests = threads.submit(come_and_go)
        while not done.is_set():
            bus.wait(never, 0.0002)
        requests.result(_LONG)
        receivers.wait(bus, never)


class Waiting:
    """A thread's waiting on a bus, until its end."""

    def __init__(self, bus, threads):
        self._bus = bus
        self._wakeup = WakeupEvent()
        self._is_over = False
        self._thread = threads.submit(self._wait)

    def end(self):
        """Let the thread go away for good."""
        self._is_over = True
        self._wakeup.set()
        self._thread.result(_LONG)
        self._wakeup.close()

    def _wait(self):
        while not self._is_over:
            self._bus.wait(self._wakeup, _LONG)


@pytest.mark.usefixtures("endless_patience")
def test_where_two_threads_wait_neither_depends_on_the_other(bus, other, wait_until):
    receivers = Receivers(bus)
    with ThreadPoolExecutor(2) as threads:
        first, second = Waiting(bus, threads), Waiting(bus, threads)
        first.end()
        other.publish("a", b"x")
        wait_until(lambda: receivers.threads)
        second.end()


def test_a_thread_that_waits_returns_when_the_bus_closes(bus):
    with ThreadPoolExecutor(1) as threads:
        waiting = Waiting(bus, threads)
        bus.close()
        waiting.end()


@pytest.mark.skipif(not IS_LINUX, reason="other systems read datagrams one by one")
def test_a_bus_is_prepared_for_bursts_once_a_thread_waits(bus, never, wait_until):
    """Imports take tens of milliseconds while a callback keeps the interpreter busy."""
    assert not bus._sockets._batches
    wait_until(lambda: bus.wait(never, 0.05) or bus._sockets._batches)


@pytest.mark.usefixtures("endless_patience")
def test_a_callback_may_call_a_service_of_another_program(bus_url):
    """Its own thread, which would receive the reply, waits for it."""
    lcmtools.init([], url=bus_url, handle_signals=False)
    node = lcmtools.Node("caller")
    client = node.create_client(Trigger, "/answer")
    answers = []
    node.create_timer(0.01, lambda: answers.append(client.call(Trigger.Request(), _LONG).success))
    answering = threading.Event()
    with ThreadPoolExecutor(1) as threads:
        serving = threads.submit(_serve, bus_url, answering)
        while not answers:
            lcmtools.spin_once(node, 1.0)
        answering.set()
        serving.result(_LONG)
    assert answers == [True]
    lcmtools.shutdown()


def _serve(bus_url, answering):
    from lcmtools.arguments import NodeArguments
    from lcmtools.node.process import open_context

    def answer(_request, response):
        response.success = True
        return response

    context = open_context(parse_url(bus_url), NodeArguments())
    node = lcmtools.Node("server", context=context)
    node.create_service(Trigger, "/answer", answer)
    while not answering.is_set():
        lcmtools.spin_once(node, 0.05)
    context.close()


@pytest.mark.usefixtures("endless_patience")
def test_a_signal_handler_may_shut_down_while_the_node_waits(bus_url):
    lcmtools.init([], url=bus_url, handle_signals=False)
    node = lcmtools.Node("node")
    node.create_subscription(String, "/a", lambda _: None)
    before = signal.signal(signal.SIGALRM, lambda *_: lcmtools.shutdown())
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.1)
        lcmtools.spin(node)
    finally:
        signal.signal(signal.SIGALRM, before)
    assert not lcmtools.ok()


@pytest.fixture
def stream(other):
    """Messages on "a", a millisecond or two after each other, until the test ends."""
    ended = threading.Event()

    def send():
        while not ended.wait(0.001):
            other.publish("a", b"x")

    with ThreadPoolExecutor() as pool:
        pool.submit(send)
        yield
        ended.set()


@pytest.mark.usefixtures("stream")
def test_a_stream_keeps_no_request_and_no_event_waiting(bus, never):
    receivers, others = Receivers(bus), Receivers(bus, "b")
    receivers.wait(bus, never, 10)
    with ThreadPoolExecutor() as pool:
        made = pool.submit(bus.subscribe, "c", lambda *_: None)
        while not made.done():
            bus.wait(never, _LONG)
    bus.publish("b", b"x")
    others.wait(bus, never)
    receivers.wait(bus, never, len(receivers.threads) + 10)
    never.set()
    while never.is_set:  # cleared by the wait that it ends
        bus.wait(never, _LONG)


@pytest.fixture
def in_a_stream(bus, other, never, monkeypatch):
    """The bus counts what comes as a stream, whose next message it awaits without end."""
    receivers, sent = Receivers(bus), 0
    with ThreadPoolExecutor() as pool:
        while not bus._is_streaming:
            sent += 1
            pool.submit(lambda: time.sleep(0.001) or other.publish("a", b"x"))
            receivers.wait(bus, never, sent)
    monkeypatch.setattr(udp_bus, "_GAP", 3_600)


@pytest.mark.usefixtures("in_a_stream")
def test_a_short_wait_is_short_in_a_stream_too(bus, never):
    bus.wait(never, 0.01)
    assert bus._is_streaming  # it could have waited for the next message, but for the time


@pytest.mark.usefixtures("in_a_stream")
def test_a_signal_ends_a_wait_in_a_stream_and_frees_the_right_to_receive(bus, never):
    def interrupt(*_):
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, interrupt)
    try:
        with pytest.raises(KeyboardInterrupt):  # noqa: PT012 - the signal may come early
            signal.setitimer(signal.ITIMER_REAL, 0.1)
            bus.wait(never, None)
    finally:
        signal.signal(signal.SIGALRM, before)
    bus.subscribe("b", lambda *_: None)
