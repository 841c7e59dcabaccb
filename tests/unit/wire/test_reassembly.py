"""Putting fragments together: order, loss, duplicates, several senders, and hostile floods."""

import random
import tracemalloc
from itertools import chain, zip_longest

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lcmtools.wire import datagram as wire
from lcmtools.wire.datagram import Fragment, ShortMessage
from lcmtools.wire.reassembly import Reassembler

_CHANNEL = "/camera/image"
_NAME_BYTES = len(_CHANNEL) + 1
_ALICE, _BOB = ("10.0.0.1", 40_000), ("10.0.0.2", 40_000)


def _cut(payload, seqno=1):
    parts = [wire.parse(part) for part in wire.fragments(seqno, _CHANNEL, payload)]
    return [part for part in parts if isinstance(part, Fragment)]


def _feed(reassembler, parts, sender=_ALICE):
    answers = [reassembler.add(sender, part) for part in parts]
    return [answer for answer in answers if answer is not None]


def _held(reassembler):
    """The number of incomplete messages, and the bytes kept for them."""
    return len(reassembler._incomplete), reassembler._bytes


def _payload(size, seed=0):
    return random.Random(seed).randbytes(size)  # noqa: S311 - a picture, no secret


@pytest.mark.parametrize("order", ["forwards", "backwards", "shuffled", "twice each"])
@pytest.mark.parametrize(
    "size",
    sorted(
        {
            multiple * wire.FRAGMENT_MAX - _NAME_BYTES + extra
            for multiple in (1, 2, 3)
            for extra in (-1, 0, 1)
        }
        | {wire.SHORT_MESSAGE_MAX + extra for extra in (-1, 0, 1, 2)}
        | {0, 1, 200_000, 1_000_000}
    ),
)
def test_a_message_of_any_size_comes_back_whole(size, order):
    payload = _payload(size)
    parts = _cut(payload)
    if order == "backwards":
        parts.reverse()
    elif order == "shuffled":
        random.Random(1).shuffle(parts)  # noqa: S311
    elif order == "twice each":
        parts = [part for part in parts for _ in range(2)][:-1]
    assert _feed(Reassembler(), parts) == [ShortMessage(1, _CHANNEL, payload)]


def test_a_message_is_cut_as_often_as_liblcm_cuts_it():
    whole = wire.FRAGMENT_MAX - _NAME_BYTES
    assert len(_cut(bytes(whole))) == 1
    assert len(_cut(bytes(whole + 1))) == 2
    assert len(_cut(bytes(whole + wire.FRAGMENT_MAX))) == 2
    assert len(_cut(bytes(whole + wire.FRAGMENT_MAX + 1))) == 3


def test_interleaved_senders_with_equal_numbers_stay_apart():
    reassembler = Reassembler()
    a, b = _payload(200_000, 1), _payload(200_000, 2)
    got = {}
    for one, other in zip_longest(_cut(a), _cut(b)):
        for sender, part in ((_ALICE, one), (_BOB, other)):
            message = reassembler.add(sender, part)
            if message:
                got[sender] = message.payload
    assert got == {_ALICE: a, _BOB: b}


def test_interleaved_messages_of_one_sender_stay_apart():
    a, b = _payload(200_000, 1), _payload(150_000, 2)
    mixed = chain.from_iterable(zip_longest(_cut(a, 4), _cut(b, 5)))
    got = _feed(Reassembler(), [part for part in mixed if part is not None])
    assert {message.seqno: message.payload for message in got} == {4: a, 5: b}


def test_a_sequence_number_that_comes_again_after_the_wrap_is_a_new_message():
    reassembler = Reassembler()
    old, new = _cut(_payload(200_000, 1), 9), _payload(150_000, 2)
    assert _feed(reassembler, old[:2]) == []  # the rest was lost
    assert _feed(reassembler, _cut(new, 9)) == [ShortMessage(9, _CHANNEL, new)]
    assert _held(reassembler) == (0, 0)


@pytest.mark.parametrize("lost", [0, 1, 3])
def test_a_message_with_a_lost_fragment_never_comes(lost):
    parts = _cut(_payload(200_000))
    del parts[lost]
    assert _feed(Reassembler(), parts) == []


def _fragment(number, offset, part, **changes):
    values = {
        "seqno": 1,
        "message_size": 6,
        "offset": offset,
        "number": number,
        "count": 2,
        "channel": "A" if number == 0 else None,
        "part": part,
    }
    return Fragment(**{**values, **changes})


@pytest.mark.parametrize(
    "parts",
    [
        pytest.param([_fragment(0, 0, b"abc"), _fragment(1, 2, b"def")], id="overlap"),
        pytest.param([_fragment(0, 0, b"abc"), _fragment(1, 4, b"de")], id="gap"),
        pytest.param([_fragment(0, 0, b"abc"), _fragment(1, 3, b"de")], id="short"),
        pytest.param([_fragment(0, 3, b"abc"), _fragment(1, 0, b"def")], id="swapped"),
        pytest.param([_fragment(0, 0, b""), _fragment(1, 0, b"")], id="empty"),
    ],
)
def test_parts_that_do_not_join_are_given_up(parts):
    reassembler = Reassembler()
    assert _feed(reassembler, parts) == []
    assert _held(reassembler) == (0, 0)


def test_the_same_number_with_another_size_starts_anew():
    reassembler = Reassembler()
    reassembler.add(_ALICE, _fragment(1, 3, b"xyz", message_size=9, count=3))
    assert _feed(reassembler, [_fragment(0, 0, b"abc"), _fragment(1, 3, b"def")]) == [
        ShortMessage(1, "A", b"abcdef")
    ]
    assert _held(reassembler) == (0, 0)


def test_no_more_messages_are_kept_than_allowed():
    reassembler = Reassembler(max_messages=10)
    for seqno in range(100):
        reassembler.add(_ALICE, _fragment(0, 0, b"abc", seqno=seqno))
    assert _held(reassembler)[0] == 10
    kept = _fragment(1, 3, b"def", seqno=99)
    assert reassembler.add(_ALICE, kept) == ShortMessage(99, "A", b"abcdef")
    lost = _fragment(1, 3, b"def", seqno=0)
    assert reassembler.add(_ALICE, lost) is None


def test_the_message_that_was_touched_last_is_kept_longest():
    reassembler = Reassembler(max_messages=2)
    for seqno in (1, 2):
        reassembler.add(_ALICE, _fragment(0, 0, b"abc", seqno=seqno, count=3))
    reassembler.add(_ALICE, _fragment(1, 3, b"d", seqno=1, count=3))
    reassembler.add(_ALICE, _fragment(0, 0, b"abc", seqno=3, count=3))  # pushes out 2
    last = _fragment(2, 4, b"ef", seqno=1, count=3)
    assert reassembler.add(_ALICE, last) == ShortMessage(1, "A", b"abcdef")


def test_no_more_bytes_are_kept_than_allowed():
    reassembler = Reassembler(max_bytes=1_000_000)
    for seqno in range(50):
        _feed(reassembler, _cut(bytes(200_000), seqno)[:-1])
        assert _held(reassembler)[1] <= 1_000_000


def _memory_of(parts, reassembler):
    """Bytes that reassembling takes at its peak."""
    tracemalloc.start()
    try:
        for sender, part in parts:
            reassembler.add(sender, part)
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_a_claim_of_256_mib_allocates_nothing():
    claims = (
        (_ALICE, _fragment(0, 0, b"x", seqno=n, message_size=wire.MESSAGE_MAX, count=65_535))
        for n in range(1000)
    )
    assert _memory_of(claims, Reassembler()) < 2_000_000


def test_a_flood_of_empty_parts_of_one_message_is_bounded():
    flood = ((_ALICE, _fragment(n, 0, b"", count=65_535, channel=None)) for n in range(1, 65_535))
    assert _memory_of(flood, Reassembler(max_bytes=1_000_000)) < 2_000_000


def test_a_flood_of_empty_parts_across_messages_is_bounded():
    flood = (
        (("10.0.0.1", seqno), _fragment(n, 0, b"", seqno=seqno, count=65_535, channel=None))
        for n in range(1, 100)
        for seqno in range(500)
    )
    assert _memory_of(flood, Reassembler(max_bytes=1_000_000)) < 2_000_000


def test_a_message_that_is_larger_than_the_bound_leaves_nothing_behind():
    reassembler = Reassembler(max_bytes=100_000)
    assert _feed(reassembler, _cut(bytes(300_000))) == []
    assert _held(reassembler)[1] <= 100_000


_ANY_FRAGMENT = st.builds(
    Fragment,
    seqno=st.integers(0, 3),
    message_size=st.integers(0, 12),
    offset=st.integers(0, 12),
    number=st.integers(0, 4),
    count=st.integers(1, 5),
    channel=st.sampled_from([None, "A"]),
    part=st.binary(max_size=6),
).filter(lambda part: part.number < part.count)


@settings(max_examples=300)
@given(st.lists(st.tuples(st.sampled_from([_ALICE, _BOB]), _ANY_FRAGMENT), max_size=60))
def test_any_fragments_keep_the_books_straight(parts):
    reassembler = Reassembler(max_bytes=5000, max_messages=3)
    for sender, part in parts:
        message = reassembler.add(sender, part)
        assert message is None or message.seqno == part.seqno
        messages, held = _held(reassembler)
        assert 0 <= messages <= 3
        assert 0 <= held <= 5000
        assert (messages == 0) == (held == 0)


def test_messages_that_stay_incomplete_are_counted_if_their_channel_is_known():
    reassembler = Reassembler()
    first, *others = _cut(_payload(200_000))
    reassembler.add(_ALICE, first, 10)
    for part in others:
        reassembler.add(_BOB, part, 20)
    reassembler.drop_before(10)
    assert (reassembler.lost, reassembler.has_first(_ALICE, 1)) == ({}, True)
    reassembler.drop_before(21)
    assert reassembler.lost == {"/camera/image": 1}
    assert reassembler.kept_bytes == 0
    assert not reassembler.has_first(_ALICE, 1)
