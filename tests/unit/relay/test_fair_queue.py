"""Messages that wait for a slow connection: who goes first, and who makes room."""

from lcmtools.relay.fair_queue import LATE, FairQueue

_NEVER = float("inf")


def _queue(*messages):
    """A queue of (channel, number, bytes), all of time 0."""
    queue = FairQueue()
    for channel, number, size in messages:
        queue.add(channel, (channel, number), size, LATE, 0.0)
    return queue


def test_where_little_waits_all_leave_in_the_order_of_coming():
    queue = _queue(*(("ab"[number % 2], number, 100) for number in range(10)))
    assert [number for _, number in queue.pop(0.0, 1 << 20)] == list(range(10))
    assert not queue


def test_a_command_waits_for_no_image_and_a_small_image_for_no_large_one():
    queue = _queue(("large", 1, 50_000), ("small", 2, 9000), ("small", 3, 9000), ("command", 4, 8))
    assert queue.pop(0.0, 1) == [("command", 4)]
    assert queue.pop(0.0, 1 << 20) == [("small", 2), ("small", 3), ("large", 1)]


def test_no_more_is_taken_than_was_asked_for():
    queue = _queue(*(("a", number, 1000) for number in range(10)))
    assert len(queue.pop(0.0, 2000)) == 2
    assert len(queue) == 8


def test_what_is_late_is_dropped_whatever_waits_before_it():
    queue = _queue(("a", 1, 8), ("b", 2, 8))
    queue.add("a", ("a", 3), 8, _NEVER, 0.0)
    assert queue.pop(LATE + 0.1, 1 << 20) == [("a", 3)]
    assert queue.dropped == 2


def test_a_channel_with_much_data_keeps_the_newest_after_a_moment():
    messages = [("image", number, 30_000) for number in range(10)]
    assert len(_queue(*messages).pop(0.2, 1 << 20)) == 10  # a burst passes
    queue = _queue(*messages, ("command", 1, 8))
    assert queue.pop(0.3, 1 << 20) == [("command", 1), ("image", 8), ("image", 9)]
    assert queue.dropped == 8
