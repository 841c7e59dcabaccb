"""The kernel's receive times, on computers of 64 and of 32 bits."""

import socket
import struct
import sys

import pytest

from lcmtools.bus.kernel import IS_LINUX, STAMP_KIND, arrival, received_at

_TIME = 1_700_000_000_123_456_789


@pytest.mark.skipif(not IS_LINUX, reason="other systems have other stamps")
@pytest.mark.parametrize("layout", ["=qq", "=ii"])
def test_the_size_of_a_stamp_tells_its_layout(layout):
    stamp = struct.pack(layout, *divmod(_TIME, 1_000_000_000))
    assert received_at(stamp) == _TIME
    ttl = (socket.IPPROTO_IP, socket.IP_TTL, (3).to_bytes(4, sys.byteorder))
    assert arrival([(socket.SOL_SOCKET, STAMP_KIND, stamp), ttl]) == (_TIME, 3)


@pytest.mark.parametrize("stamp", [b"", b"1234", bytes(24)])
def test_what_is_no_stamp_counts_as_now(stamp):
    assert received_at(stamp) > _TIME
