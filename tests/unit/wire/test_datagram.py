"""LCM's datagrams: known bytes, what cannot be read, and round trips."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.wire import datagram as wire
from lcmtools.wire.datagram import Fragment, MalformedDatagram, ShortMessage


def test_a_short_message_has_the_bytes_that_liblcm_sends():
    # captured from lcm 1.5.3: LCM().publish("EXAMPLE", b"hello") as the third message
    captured = bytes.fromhex("4c43303200000002 4558414d504c4500 68656c6c6f")
    assert wire.short_message(2, "EXAMPLE", b"hello") == captured
    assert wire.parse(captured) == ShortMessage(2, "EXAMPLE", b"hello")


def test_a_fragment_has_the_bytes_that_liblcm_sends():
    first, second = wire.fragments(7, "BIG", bytes(65_500))
    assert first[:24] == bytes.fromhex("4c433033 00000007 0000ffdc 00000000 0000 0002 42494700")
    assert second[:20] == bytes.fromhex("4c433033 00000007 0000ffdc 0000ffcb 0001 0002")
    assert len(first) == 20 + wire.FRAGMENT_MAX
    assert len(second) == 20 + 65_500 + 4 - wire.FRAGMENT_MAX


@pytest.mark.parametrize(
    ("channel", "size", "fits"),
    [
        ("CH", 65_499 - 3, True),
        ("CH", 65_499 - 2, False),
        ("C" * 63, 65_499 - 64, True),
        ("C" * 63, 65_499 - 63, False),
        ("é", 65_499 - 3, True),
        ("é", 65_499 - 2, False),
    ],
)
def test_a_message_is_short_up_to_65499_bytes_with_its_channel(channel, size, *, fits):
    first = next(wire.datagrams(1, channel, bytes(size)))
    assert first.startswith(wire.MAGIC_SHORT) is fits


@pytest.mark.parametrize("seqno", [0, 1, 0xFFFFFFFF])
@pytest.mark.parametrize("channel", ["", "a", "/a b*", "été", "C" * 63, "\udcff\udc80"])
@pytest.mark.parametrize("payload", [b"", b"\0", b"payload\0", bytes(1000)])
def test_a_short_message_survives_the_way_there_and_back(seqno, channel, payload):
    sent = wire.short_message(seqno, channel, payload)
    assert wire.parse(sent) == ShortMessage(seqno, channel, payload)


def test_the_sequence_number_wraps_at_32_bits():
    assert wire.parse(wire.short_message((1 << 32) + 5, "a", b"")) == ShortMessage(5, "a", b"")
    parts = [wire.parse(part) for part in wire.fragments((1 << 32) + 5, "a", bytes(70_000))]
    assert {part.seqno for part in parts if isinstance(part, Fragment)} == {5}


def test_a_message_that_receivers_refuse_is_not_cut():
    class Huge(bytes):
        def __len__(self):
            return wire.MESSAGE_MAX + 1

    with pytest.raises(ValueError, match="refuse more than 268435456"):
        next(wire.fragments(0, "a", Huge()))


_HEADER = b"LC03" + bytes.fromhex("00000001")


@pytest.mark.parametrize(
    ("datagram", "reason"),
    [
        (b"", "not with LC02 or LC03"),
        (b"L", "not with LC02 or LC03"),
        (b"LC01" + bytes(20), "not with LC02 or LC03"),
        (b"\xff" * 65_507, "not with LC02 or LC03"),
        (b"LC02", "short message: shorter than its header"),
        (b"LC02\0\0\0", "short message: shorter than its header"),
        (b"LC02\0\0\0\0", "channel name not ended"),
        (b"LC02\0\0\0\0abc", "channel name not ended"),
        (b"LC02\0\0\0\0" + b"a" * 64 + b"\0", "channel name not ended"),
        (b"LC02\0\0\0\0" + b"a" * 70 + b"\0payload", "channel name not ended"),
        (b"LC03", "fragment: shorter than its header"),
        (b"LC03" + bytes(15), "fragment: shorter than its header"),
        (_HEADER + bytes.fromhex("00000010 00000000 0000 0000") + b"a\0", "number 0 of 0"),
        (_HEADER + bytes.fromhex("00000010 00000000 0002 0002") + b"abc", "number 2 of 2"),
        (_HEADER + bytes.fromhex("00000010 00000000 ffff 0001") + b"abc", "number 65535 of 1"),
        (_HEADER + bytes.fromhex("10000001 00000000 0001 0002") + b"abc", "268435457 bytes"),
        (_HEADER + bytes.fromhex("ffffffff 00000000 0001 0002") + b"abc", "4294967295 bytes"),
        (_HEADER + bytes.fromhex("00000002 00000000 0001 0002") + b"abc", "beyond the message's 2"),
        (_HEADER + bytes.fromhex("00000010 0000000e 0001 0002") + b"abc", "beyond the message's"),
        (_HEADER + bytes.fromhex("00000010 ffffffff 0001 0002") + b"abc", "beyond the message's"),
        (_HEADER + bytes.fromhex("00000010 00000000 0000 0002") + b"abc", "channel name not ended"),
        (
            _HEADER + bytes.fromhex("00000000 00000000 0000 0001") + b"a\0b",
            "beyond the message's 0",
        ),
    ],
)
def test_a_datagram_that_is_none_of_lcms_says_why(datagram, reason):
    parsed = wire.parse(datagram)
    assert isinstance(parsed, MalformedDatagram)
    assert reason in parsed.reason


def test_an_empty_channel_on_the_wire_is_read():
    assert wire.parse(b"LC02\0\0\0\x01\0x") == ShortMessage(1, "", b"x")


def test_a_channel_that_is_not_utf8_keeps_its_bytes():
    parsed = wire.parse(b"LC02\0\0\0\x01\xff\xfe\0x")
    assert isinstance(parsed, ShortMessage)
    assert parsed.channel == "\udcff\udcfe"
    assert wire.short_message(1, parsed.channel, b"x") == b"LC02\0\0\0\x01\xff\xfe\0x"


@given(st.sampled_from([b"LC02", b"LC03"]), st.binary(max_size=120))
def test_any_bytes_after_a_magic_are_read_without_an_exception(magic, rest):
    parsed = wire.parse(magic + rest)
    assert isinstance(parsed, ShortMessage | Fragment | MalformedDatagram)
    if isinstance(parsed, Fragment):
        assert parsed.number < parsed.count
        assert parsed.offset + len(parsed.part) <= parsed.message_size <= wire.MESSAGE_MAX
        assert (parsed.channel is not None) == (parsed.number == 0)
