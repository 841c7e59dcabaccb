"""The frames of tcpq."""

import struct
from itertools import pairwise

import pytest
from fixtures.wire import subscribe_frame, unsubscribe_frame
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.wire.tcpq import (
    CLIENT_GREETING,
    PUBLISH,
    SUBSCRIBE,
    UNSUBSCRIBE,
    FrameReader,
    StreamError,
    payload_of,
    publish_frame,
)


@given(st.lists(st.binary(max_size=20), max_size=4), st.lists(st.integers(0, 200)))
def test_frames_come_whole_however_they_are_cut(payloads, cuts):
    data = CLIENT_GREETING + b"".join(publish_frame("/ä", payload) for payload in payloads)
    reader, found = FrameReader(), []
    for start, end in pairwise(sorted({0, len(data), *(min(cut, len(data)) for cut in cuts)})):
        found += reader.read(data[start:end])
    assert [(one.kind, one.name, payload_of(one)) for one in found] == [
        (PUBLISH, "/ä", payload) for payload in payloads
    ]


def test_subscriptions_have_patterns():
    reader = FrameReader()
    data = CLIENT_GREETING + subscribe_frame("A.*") + unsubscribe_frame("A.*")
    assert [(one.kind, one.name) for one in reader.read(data)] == [
        (SUBSCRIBE, "A.*"),
        (UNSUBSCRIBE, "A.*"),
    ]


def _bad(data):
    with pytest.raises(StreamError) as caught:
        list(FrameReader().read(data))
    return caught.value.what


def test_what_is_no_tcpq_is_named():
    assert _bad(b"GET / HTTP") == "it does not speak tcpq, it begins with b'GET / HT'"
    assert _bad(b"G") == "it does not speak tcpq, it begins with b'G'"
    kind = struct.pack(">II", 9, 1)
    assert _bad(CLIENT_GREETING + kind) == "it sent a frame of the unknown kind 9"
    for size in (0, 256, 1 << 31):
        name = struct.pack(">II", PUBLISH, size)
        assert _bad(CLIENT_GREETING + name) == f"it sent a name of {size} bytes"
    large = struct.pack(">II", PUBLISH, 1) + b"a" + struct.pack(">I", (1 << 28) + 1)
    assert "it sent a message of 268435457 bytes" in _bad(CLIENT_GREETING + large)


def test_a_claimed_size_takes_no_memory():
    reader = FrameReader()
    claim = struct.pack(">II", PUBLISH, 1) + b"a" + struct.pack(">I", 1 << 28)
    assert list(reader.read(CLIENT_GREETING + claim)) == []
    assert len(reader._bytes) == len(claim)
