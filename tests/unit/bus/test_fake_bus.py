"""The fake bus keeps the promises of the real one."""

import pytest
from fixtures.fake_bus import FakeBus

from lcmtools.errors import BusError, InvalidName


def test_a_message_reaches_every_handler_of_exactly_its_channel():
    bus = FakeBus()
    heard = []
    bus.subscribe("/a.b+", lambda payload, _: heard.append(("one", payload)))
    bus.subscribe("/a.b+", lambda payload, _: heard.append(("two", payload)))
    bus.subscribe("/aXb+", lambda payload, _: heard.append(("other", payload)))
    bus.publish("/a.b+", b"x")
    assert heard == [("one", b"x"), ("two", b"x")]


def test_everything_that_is_sent_is_kept():
    bus = FakeBus()
    bus.publish("a", b"1")
    bus.publish("b", b"2")
    assert bus.published == [("a", b"1"), ("b", b"2")]
    assert bus.ports == []


def test_an_unsubscribed_handler_hears_nothing_even_when_undone_twice():
    bus = FakeBus()
    heard = []

    def handler(payload, _time):
        heard.append(payload)
        bus.unsubscribe("a", handler)

    bus.subscribe("a", handler)
    bus.publish("a", b"1")
    bus.publish("a", b"2")
    bus.unsubscribe("a", handler)
    assert heard == [b"1"]


@pytest.mark.parametrize("channel", ["", "a" * 64, "a\0"])
def test_a_channel_that_lcm_cannot_carry_is_refused(channel):
    bus = FakeBus()
    with pytest.raises(InvalidName):
        bus.publish(channel, b"")
    with pytest.raises(InvalidName):
        bus.subscribe(channel, lambda _payload, _time: None)


def test_a_closed_bus_takes_no_message():
    bus = FakeBus()
    bus.close()
    bus.close()
    with pytest.raises(BusError, match="closed"):
        bus.publish("a", b"")
    bus.unsubscribe("a", lambda _payload, _time: None)
