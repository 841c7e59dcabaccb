"""Messages that wait for a slow network: of each topic the newest, in order, each in its turn."""

import threading
import time
from collections.abc import Callable

from lcmtools.bus.zenoh.keep_last_sender import (
    CLOCK,
    MOST_WAITING_BYTES,
    KeepLastSender,
    Outgoing,
)


class _Line:
    """A network that takes a message when it is told to."""

    def __init__(self):
        self.taken = []
        self.begun = threading.Semaphore(0)
        self.room = threading.Semaphore(0)

    def put(self, message):
        """Take a message when there is room."""
        self.begun.release()
        self.room.acquire()
        self.taken.append(message)


def _message(key, number, size=8):
    return Outgoing(key, bytes([number]) * size)


def _numbers(line, key):
    return [message.payload[0] for message in line.taken if message.key == key]


def test_commands_wait_in_order_and_images_are_replaced_by_newer_ones():
    line = _Line()
    sender = KeepLastSender(line.put)
    sender.add(_message("other", 0))
    line.begun.acquire()  # the line is busy from now on
    for number in range(100):
        sender.add(_message("command", number))
        sender.add(_message("image", number, MOST_WAITING_BYTES + 1))
    assert sender.has_waiting("command")
    assert sender.has_waiting("other")
    assert not sender.has_waiting("another")
    line.room.release(102)
    sender.close()
    assert _numbers(line, "command") == list(range(100))
    assert _numbers(line, "image") == [99]
    assert sender.dropped == 99


class _Interrupted(bytes):
    """A payload while whose size is computed a signal handler runs, once."""

    handle: Callable[[], None] | None = None

    def __len__(self):
        """Return the size."""
        handle, self.handle = self.handle, None
        if handle:
            handle()
        return super().__len__()


def test_a_signal_handler_may_publish_while_a_message_is_queued():
    line = _Line()
    sender = KeepLastSender(line.put)
    sender.add(_message("other", 0))
    line.begun.acquire()  # the line is busy from now on
    for number in range(2):
        payload = _Interrupted([number] * (MOST_WAITING_BYTES + 1))
        payload.handle = lambda: sender.add(_message("a", 2, MOST_WAITING_BYTES + 1))
        sender.add(Outgoing("a", payload))
    line.room.release(9)
    sender.add(_message("last", 3))
    sender.close()
    assert _numbers(line, "last") == [3]


def test_each_topic_has_its_turn(wait_until):
    line = _Line()
    sender = KeepLastSender(line.put)
    for number in range(3):
        sender.add(_message("a", number))
    line.begun.acquire()
    sender.add(_message("b", 0))
    line.room.release(4)
    wait_until(lambda: len(line.taken) == 4)
    assert [message.key for message in line.taken].index("b") < 3
    sender.close()


def test_what_would_arrive_too_late_is_dropped():
    line = _Line()
    sender = KeepLastSender(line.put)
    now = time.clock_gettime_ns(CLOCK)
    sender.add(_message("other", 0))
    line.begun.acquire()
    sender.add(_message("a", 1)._replace(time=now - 10**9))
    sender.add(_message("a", 2)._replace(time=now + 10**12))
    sender.add(_message("state", 3))
    line.room.release(3)
    sender.close()
    assert {message.payload[0] for message in line.taken} == {0, 2, 3}
    assert sender.dropped == 1


def test_closing_waits_for_half_a_second_only():
    line = _Line()
    sender = KeepLastSender(line.put)
    sender.add(_message("a", 0))
    sender.close()  # the line never has room
    assert line.taken == []
    line.room.release()


def test_images_wait_through_a_short_stall_of_the_network():
    line = _Line()
    sender = KeepLastSender(line.put)
    now = time.clock_gettime_ns(CLOCK)
    sender.add(_message("other", 0))
    line.begun.acquire()
    for number in range(20):  # 30 Hz
        sender.add(_message("image", number, 20_000)._replace(time=now + number * 33_000_000))
    line.room.release(20)
    sender.close()
    assert _numbers(line, "image") == list(range(12, 20))  # those of the last 0.25 s
    assert sender.dropped == 12
