"""Stamps beside messages."""

from hypothesis import given
from hypothesis import strategies as st

from lcmtools.wire.stamp import Origin, Stamp, decode_stamp, encode_stamp

_IDS = _TIMES = st.integers(0, 2**64 - 1)
_NUMBERS = st.integers(0, 2**32 - 1)
_ORIGINS = st.builds(Origin, _IDS, _NUMBERS, st.integers(1, 255))


@given(_IDS, _NUMBERS, _TIMES, st.none() | _ORIGINS)
def test_stamp_comes_back(sender, seqno, time, origin):
    data = encode_stamp(sender, seqno, time, origin)
    assert decode_stamp(data) == Stamp(sender, seqno, time, origin or Origin(sender, seqno))
    assert len(data) == (34 if origin else 22)
    assert decode_stamp(data + b"more") == decode_stamp(data)  # what a later version appends


@given(st.binary(max_size=40))
def test_other_bytes_are_no_stamp(data):
    stamp = decode_stamp(data)
    assert (stamp is not None) == (
        data[:1] == b"\3" and len(data) >= (34 if data[1:2] > b"\0" else 22)
    )


def test_numbers_begin_again_and_hops_do_not():
    data = encode_stamp(7, 2**32 + 5, 9, Origin(8, 2**32, 300))
    assert decode_stamp(data) == Stamp(7, 5, 9, Origin(8, 0, 255))
