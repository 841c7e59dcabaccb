"""The filter of a channel socket, run here by a small machine of the tests' own."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.bus.socket_filter import these_channels, wanted
from lcmtools.wire.datagram import fragments, short_message


def one_channel(channel):
    """As ``ChannelSocket`` makes it."""
    return wanted(these_channels([channel]), heads=True)


_CHANNELS = st.text("ab/_", min_size=1, max_size=63)


@given(channel=_CHANNELS, payload=st.binary(max_size=20))
def test_the_messages_of_the_channel_come_through(lets_pass, channel, payload):
    assert lets_pass(one_channel(channel), short_message(7, channel, payload))


@given(channel=_CHANNELS, more=_CHANNELS, payload=st.binary(max_size=80))
def test_those_of_other_channels_do_not(lets_pass, channel, more, payload):
    for other in {more, channel + more, channel[:-1]} - {channel, ""}:
        assert not lets_pass(one_channel(channel), short_message(7, other[:63], payload)) or (
            other[:63] == channel
        )


@pytest.mark.parametrize(
    ("sent_on", "passes"), [("/node", True), ("/nod", False), ("/nodes", False)]
)
def test_of_a_large_message_the_first_fragment_does(lets_pass, sent_on, *, passes):
    payload = b"/node\0" * 30_000  # looks as if every fragment had the channel
    first, *others = fragments(7, sent_on, payload)
    assert lets_pass(one_channel("/node"), first) == passes
    assert others
    assert not any(lets_pass(one_channel("/node"), other) for other in others)


@given(datagram=st.binary(max_size=60))
def test_what_is_no_message_does_not(lets_pass, datagram):
    assert not lets_pass(one_channel("/node"), datagram)
