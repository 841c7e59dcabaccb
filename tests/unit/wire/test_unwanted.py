"""Which large messages the kernel is to drop."""

import pytest

from lcmtools.bounded import MOST_ENTRIES
from lcmtools.wire.reassembly import UnwantedMessages

_IMAGES = 4000, 921_600
_MS = 1_000_000


def _stream(messages, count, period=_MS, start=0):
    """Let fragments come; return after how many their messages are denied, 0 for never."""
    for number in range(count):
        if messages.note(*_IMAGES, start + number * period):
            return number + 1
    return 0


def test_a_fast_stream_is_denied():
    messages = UnwantedMessages()
    assert _stream(messages, 100) == 41
    assert messages.denied == [_IMAGES]
    assert not messages.note(*_IMAGES, 101 * _MS)  # what still waited


def test_a_slow_stream_passes():
    messages = UnwantedMessages()
    assert _stream(messages, 1000, 6 * _MS) == 0
    assert _stream(messages, 30, start=9000 * _MS) == 0
    assert messages.denied == []


def test_a_clock_that_is_set_back_begins_again():
    messages = UnwantedMessages()
    _stream(messages, 40, start=10_000 * _MS)
    assert _stream(messages, 40) == 0


@pytest.mark.parametrize("other", [(4001, 921_600), (4000, 921_601)])
def test_ports_and_sizes_are_counted_apart(other):
    messages = UnwantedMessages()
    assert not any(
        messages.note(*one, number * _MS) for number in range(40) for one in (_IMAGES, other)
    )


def test_a_port_with_a_wanted_message_is_never_denied_again():
    messages = UnwantedMessages()
    _stream(messages, 41)
    messages.denied.append((4001, 5))
    assert messages.want(4000)
    assert messages.denied == [(4001, 5)]
    assert not messages.want(4000)
    assert _stream(messages, 1000) == 0


def test_the_newest_few_are_denied():
    messages = UnwantedMessages()
    for size in range(20):
        while not messages.note(4000, size, 0):
            pass
    assert messages.denied == [(4000, size) for size in range(4, 20)]


def test_other_channels_begin_anew():
    messages = UnwantedMessages()
    _stream(messages, 40)
    messages.clear()
    assert _stream(messages, 40) == 0
    _stream(messages, 1)
    messages.clear()
    assert messages.denied == []


def test_strangers_fill_no_memory():
    messages = UnwantedMessages()
    for number in range(2 * MOST_ENTRIES):
        messages.note(number, number, 0)
        messages.want(number)
    assert len(messages._counts) == len(messages._wanted) == MOST_ENTRIES
