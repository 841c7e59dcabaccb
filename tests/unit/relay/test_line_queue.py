"""Messages that wait for a slow line, and the echoes of a server."""

import time

from lcmtools.relay.echo import EchoFilter
from lcmtools.relay.fair_queue import LineMessage, LineQueue


def _drain(queue):
    taken = []
    while queue:
        taken += [(one.channel, one.payload) for one in queue.pop(0.0)]
    return taken


def test_messages_leave_in_order_and_the_protocols_first():
    queue = LineQueue()
    queue.add([LineMessage("a", b"1"), LineMessage("b", b"2")])
    queue.add([LineMessage("a", b"3")])
    queue.add_first(LineMessage("node", b"0"))
    assert _drain(queue) == [("node", b"0"), ("a", b"1"), ("b", b"2"), ("a", b"3")]
    assert queue.pop(0.0) == []


def test_only_the_newest_of_a_topic_waits():
    queue = LineQueue()
    for number in range(3):
        queue.add(
            [LineMessage("image", b"%d" % number, newest=True), LineMessage("a", b"%d" % number)]
        )
    assert _drain(queue) == [("a", b"0"), ("a", b"1"), ("image", b"2"), ("a", b"2")]
    assert queue.waiting.dropped == 2


def test_the_topic_that_takes_the_most_room_makes_way():
    queue = LineQueue(most_bytes=10_000)
    queue.add([LineMessage("cmd", b"stop")])
    for number in range(30):
        queue.add([LineMessage("image", bytes([number]) * 2000)])
    left = _drain(queue)
    assert left[0] == ("cmd", b"stop")
    assert [payload[0] for _, payload in left[1:]] == [26, 27, 28, 29]
    assert queue.waiting.dropped == 26


def test_a_message_that_is_larger_than_the_room_waits_alone():
    queue = LineQueue(most_bytes=1000)
    queue.add([LineMessage("a", bytes(10))])
    queue.add([LineMessage("b", bytes(5000))])
    assert [channel for channel, _ in _drain(queue)][-1:] == ["b"] or queue.waiting.dropped == 1


def test_what_has_waited_for_too_long_is_dropped_and_counted():
    queue = LineQueue()
    queue.add([LineMessage("cmd", b"old", due=time.monotonic()), LineMessage("map", b"state")])
    queue.add([LineMessage("cmd", b"new", due=time.monotonic() + 3600)])
    kept = [one.payload for one in queue.pop(0.0) if not queue.is_late(one)]
    assert (kept, queue.waiting.dropped) == ([b"state", b"new"], 1)


def test_what_is_dropped_at_the_end_is_counted():
    queue = LineQueue()
    queue.add([LineMessage("a", b""), LineMessage("b", b"")])
    queue.clear()
    assert (queue.waiting.dropped, queue.pop(0.0)) == (2, [])


def test_each_message_has_one_echo():
    echo = EchoFilter()
    echo.sends("a", b"1")
    echo.sends("a", b"1")
    echo.sends("b", b"1")
    assert [echo.is_echo(*one) for one in (("a", b"1"), ("a", b"2"), ("b", b"1"))] == [
        True,
        False,
        True,
    ]
    assert echo.is_echo("a", b"1")
    assert not echo.is_echo("a", b"1")


def test_an_echo_that_never_comes_is_forgotten():
    echo = EchoFilter()
    echo.sends("a", b"lost")
    for number in range(1001):
        echo.sends("b", b"%d" % number)
        assert echo.is_echo("b", b"%d" % number)
    assert not echo.is_echo("a", b"lost")
    echo.sends("a", b"x")
    echo.clear()
    assert not echo.is_echo("a", b"x")
