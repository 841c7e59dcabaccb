"""The events in the bytes of a log, sound and damaged."""

import struct

from lcmtools.wire.log_events import SYNC, packets


def _event(number, channel=b"/a", payload=b"payload"):
    head = struct.pack(">qqII", number, 1000 + number, len(channel), len(payload))
    return SYNC + head + channel + payload


def test_events_have_channel_payload_and_the_time_of_their_recording():
    first, second = packets(_event(1) + _event(2, b"/b", b""))
    assert (first.channel, first.payload, first.time) == ("/a", b"payload", 1_001_000)
    assert (second.channel, second.payload, second.time) == ("/b", b"", 1_002_000)


def test_an_event_that_is_cut_off_is_left_out():
    log = _event(1) + _event(2)
    for cut in range(1, len(_event(2)) - 1):
        found = [event.time for event in packets(log[:-cut])]
        assert 1_002_000 not in found
    assert list(packets(b"")) == []


def test_damage_costs_no_more_than_what_it_hits():
    broken = bytearray(_event(2))
    broken[20:24] = b"\xff\xff\xff\xff"  # the channel's size
    found = [event.time for event in packets(_event(1) + bytes(broken) + _event(3) + _event(4))]
    assert found == [1_001_000, 1_003_000, 1_004_000]


def test_the_sync_word_in_a_payload_is_part_of_it():
    assert [event.payload for event in packets(_event(1, payload=SYNC * 2) + _event(2))] == [
        SYNC * 2,
        b"payload",
    ]


def test_a_channel_that_is_no_utf_8_can_be_named():
    (event,) = packets(_event(1, b"a\xff"))
    assert event.channel == "a\udcff"
