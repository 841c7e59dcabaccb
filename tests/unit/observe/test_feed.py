"""The thread that reads the bus: packets become rows; an end and a failing network are shown."""

import time
from typing import ClassVar

import pytest
from fixtures.says import assert_says

from lcmtools.bus.sockets import SocketTable
from lcmtools.bus.url import BusUrl
from lcmtools.observe.channels import feed as feed_module
from lcmtools.observe.channels.feed import Feed, Snapshot
from lcmtools.observe.channels.rows import ChannelRow, ChannelSelection
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.wire.packet import Packet, Sender
from lcmtools.wire.sequence import Sequence

MEMORY = BusUrl("memq", "")


class Bus:
    """A bus that does what a test says."""

    port = 0
    is_live, is_awaiting, has_strangers = True, False, False
    numbered: ClassVar[dict[Sender, Sequence]] = {}

    def __init__(self, behaviour, *, is_log=False):
        self._behaviour = behaviour
        self.is_log = is_log

    def receive(self, timeout):
        """The clock that the test sets."""
        time.sleep(min(timeout, 0.001))
        return self._behaviour()

    def send(self, channel, payload):
        """There is no receiver."""

    def close(self):
        """Nothing is open."""


def packets():
    return [Packet("A", bytes(8), time.time_ns())]


@pytest.fixture
def snapshot_of(wait_until):
    """``snapshot_of(behaviour, condition)``: the first one that is as the test waits for it."""

    def run(behaviour, condition, meanwhile=lambda _: None, url=MEMORY):
        monitor = BusMonitor(url, "spy", {}, Bus(behaviour, is_log=url.provider == "file"))
        feed = Feed(monitor, ChannelSelection())
        feed.start()
        try:
            meanwhile(feed)
            wait_until(lambda: condition(feed.latest))
            return feed.latest
        finally:
            feed.stop()

    return run


def test_packets_become_rows(snapshot_of):
    found = snapshot_of(packets, lambda snapshot: snapshot.rate > 0)
    assert [row.channel for row in found.rows] == ["A"]
    assert (found.trouble, found.is_over) == ("", False)
    assert found.bandwidth == pytest.approx(8 * found.rate)
    assert found.row("A").messages > 1
    assert found.row("B") == ChannelRow("B")


def test_an_end_is_told_and_what_came_before_stays(snapshot_of):
    start = time.monotonic()

    def behaviour():
        if time.monotonic() - start > 0.5:
            raise EOFError
        return packets()

    found = snapshot_of(behaviour, lambda snapshot: snapshot.is_over, url=BusUrl("file", "/log"))
    assert found.trouble == "the log has ended"
    assert found.row("A").messages > 1


def test_a_network_that_fails_is_told_and_may_come_back(snapshot_of):
    failures = iter(range(3))

    def behaviour():
        if next(failures, None) is not None:
            raise OSError(100, "Network is down")
        return packets()

    told = []

    def is_back(snapshot):
        told.append(snapshot.trouble)
        return not snapshot.trouble and bool(snapshot.rows)

    assert not snapshot_of(behaviour, is_back).is_over
    assert "Network is down" in told


def test_a_fault_is_told_and_kills_nothing(snapshot_of):
    start = time.monotonic()

    def behaviour():
        if time.monotonic() - start > 0.5:
            raise ZeroDivisionError("by zero")
        return packets()

    found = snapshot_of(behaviour, lambda snapshot: snapshot.is_over)
    assert_says(found.trouble, "lcmtools", "ZeroDivisionError: by zero")


def test_who_listens_is_looked_up_again_where_there_are_other_sockets(snapshot_of, monkeypatch):
    sockets = [frozenset({1})]
    looks = []

    def listeners(*_):
        looks.append(sockets[-1])
        return [f"program {len(looks)}"]

    monkeypatch.setattr("lcmtools.observe.channels.feed._SELDOM", 0.0)
    monkeypatch.setattr(SocketTable, "listening", lambda *_: sockets[-1])
    monkeypatch.setattr("lcmtools.observe.channels.feed.plain_listeners", listeners)
    seen = {}

    def several(snapshot):
        seen[id(snapshot)] = snapshot
        if len(seen) == 4 and len(sockets) == 1:
            sockets.append(frozenset({1, 2}))
        return len(seen) >= 8

    assert snapshot_of(packets, several).plain_listeners == ("program 2",)
    assert looks == sockets


def test_clear_counts_from_zero_and_a_follower_gets_every_packet(snapshot_of, wait_until):
    taken = []
    sent = iter([packets()] * 5)
    followed = []

    def behaviour():
        return next(sent, []) if followed else []

    def meanwhile(feed):
        stop = feed.follow("A", taken.append)
        first = feed.latest
        wait_until(lambda: feed.latest is not first)  # what comes before that is nobody's
        followed.append(feed)
        wait_until(lambda: len(taken) == 5)
        stop()
        feed.clear()

    found = snapshot_of(behaviour, lambda one: one.rows and one.row("A").messages == 0, meanwhile)
    assert len(taken) == 5
    assert found.row("A").rate is None


def test_a_follower_begins_with_the_last_of_several_messages(wait_until):
    taken = []
    sent = ([Packet("A", bytes([number]), time.time_ns())] for number in range(3))
    monitor = BusMonitor(MEMORY, "spy", {}, Bus(lambda: next(sent, []) if first else []))
    feed, first = Feed(monitor, ChannelSelection(), keeps_last=True), list[Snapshot]()
    feed.on_snapshot = lambda: first.append(feed.latest)
    feed.start()
    try:
        wait_until(lambda: feed.latest.row("A").messages == 3)
        assert feed.latest.row("A").rate
        feed.follow("A", taken.append)
    finally:
        feed.stop()
    assert [packet.payload for packet in taken] == [bytes([2])]


def test_a_new_channel_and_a_clear_do_not_wait_for_the_period(wait_until):
    sent = packets()
    monitor = BusMonitor(MEMORY, "spy", {}, Bus(lambda: [sent.pop()] if sent else []))
    feed, told = Feed(monitor, ChannelSelection(), 1000.0), []
    feed.on_snapshot = lambda: told.append(feed.latest)
    feed.start()
    try:
        wait_until(lambda: len(told) == 10)  # the first ones, which come soon
        sent.append(Packet("B", bytes(8), time.time_ns()))
        wait_until(lambda: len(told) == 11)
        assert [row.channel for row in feed.latest.rows] == ["A", "B"]
        sent.append(Packet("B", bytes(8), time.time_ns()))
        wait_until(lambda: not sent)
        assert len(told) == 11
        feed.clear()
        wait_until(lambda: len(told) == 12)
        assert feed.latest.row("A").messages == 0
    finally:
        feed.stop()
    assert told[-1] is feed.latest


def test_what_follows_a_trouble_does_not_wait_for_the_period(wait_until):
    fails = False

    def behaviour():
        if fails:
            raise OSError(100, "Network is down")
        return packets()

    feed = Feed(BusMonitor(MEMORY, "spy", {}, Bus(behaviour)), ChannelSelection(), 1000.0)
    told = []
    feed.on_snapshot = lambda: told.append(feed.latest.trouble)
    feed.start()
    try:
        wait_until(lambda: len(told) == 10)
        fails = True
        wait_until(lambda: told[-1])
        fails = False
        wait_until(lambda: not told[-1])
    finally:
        feed.stop()


def test_many_silent_channels_are_shown_seldom_until_a_message_comes(wait_until, monkeypatch):
    monkeypatch.setattr(feed_module, "_QUIET_PERIOD", 1000.0)
    monkeypatch.setattr(feed_module, "_SHARE", 1)
    old, reads = time.time_ns() - 5_000_000_000, 0
    sent = [Packet(f"/a{number}", bytes(8), old) for number in range(500)]

    def behaviour():
        nonlocal reads
        reads += 1
        arrived = sent[:]
        sent.clear()
        return arrived

    feed = Feed(BusMonitor(MEMORY, "spy", {}, Bus(behaviour)), ChannelSelection(), 0.001)
    told = []
    feed.on_snapshot = lambda: told.append(feed.latest)
    feed.start()
    try:
        wait_until(lambda: len(told) == 11)  # the first ones come soon
        start = reads
        wait_until(lambda: reads > start + 500)
        assert len(told) == 11
        sent.append(Packet("/a7", bytes(8), time.time_ns()))
        wait_until(lambda: feed.latest.row("/a7").messages == 1)
    finally:
        feed.stop()
