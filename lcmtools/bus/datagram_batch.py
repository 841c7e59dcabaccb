"""Taking many datagrams from a socket with one call, recvmmsg(2) of Linux.

One by one, the call and Python's objects for the ancillary data and the address take longer than
all that is done with a datagram.
"""

import ctypes
import errno
import os
import socket
import struct
import sys
import time
from collections.abc import Iterator
from itertools import chain

from lcmtools.wire.packet import Datagram, Sender

_SLOTS = 64  # datagrams that are taken with one call
_LARGEST = 65536  # bytes of a datagram
_PART = struct.Struct("@PN")  # struct iovec
_HEADER = struct.Struct("@PIPNPNi4xI4x")  # struct mmsghdr
_SIZE = 56  # the place in it of the datagram's size
_ADDRESS_BYTES = 16  # struct sockaddr_in
# two messages of cmsg(3), each with length, level and type: the arrival's time, of two numbers, and
# the time to live; see kernel.request_arrival
_ANCILLARY = struct.Struct("@8xQ2q8xQi0N")
_OF_TIME, _OF_TTL = struct.unpack(
    "@QQ", struct.pack("@4i", socket.SOL_SOCKET, 35, socket.IPPROTO_IP, socket.IP_TTL)
)
_MOST_SENDERS = 1000  # that are remembered
IS_POSSIBLE = sys.platform == "linux" and _HEADER.size == _SIZE + 8


class DatagramBatch:
    """Buffers for the datagrams of a socket with ``kernel.request_arrival``."""

    def __init__(self, receiver: socket.socket) -> None:
        self._receiver = receiver
        self._call = ctypes.CDLL(None, use_errno=True).recvmmsg
        self._senders: dict[int, Sender] = {}
        data, self._parts, self._headers, addresses, ancillary = (
            bytearray(_SLOTS * size)
            for size in (_LARGEST, _PART.size, _HEADER.size, _ADDRESS_BYTES, _ANCILLARY.size)
        )
        self._data = memoryview(data)
        places = [*map(_address, (data, self._parts, self._headers, addresses, ancillary))]
        start, parts, headers, sources, facts = places
        self._start = ctypes.c_void_p(headers)
        fresh = bytearray()
        for slot in range(_SLOTS):
            _PART.pack_into(self._parts, slot * _PART.size, start + slot * _LARGEST, _LARGEST)
            source, part = sources + slot * _ADDRESS_BYTES, parts + slot * _PART.size
            ends = facts + slot * _ANCILLARY.size, _ANCILLARY.size
            fresh += _HEADER.pack(source, _ADDRESS_BYTES, part, 1, *ends, 0, 0)
        self._fresh = bytes(fresh)  # the call writes into the headers
        self._sizes = memoryview(self._headers).cast("I")[_SIZE // 4 :: _HEADER.size // 4]
        self._sources = memoryview(addresses).cast("Q")[:: _ADDRESS_BYTES // 8]
        self._facts = memoryview(ancillary)

    def take(self, most: int) -> Iterator[Datagram]:
        """Return those that have arrived, about so many at most; each is gone before the next.

        Raises:
            OSError: As of recvmsg(2).
        """
        return chain.from_iterable(self._calls(most))

    def _calls(self, most: int) -> Iterator[Iterator[Datagram]]:
        for _ in range(0, most, _SLOTS):
            count = self._receive()
            yield self._received(count)
            if count < _SLOTS:
                return

    def _receive(self) -> int:
        self._headers[:] = self._fresh
        count: int = self._call(
            self._receiver.fileno(), self._start, _SLOTS, socket.MSG_DONTWAIT, None
        )
        if count >= 0:
            return count
        number = ctypes.get_errno()
        if number not in (errno.EAGAIN, errno.EINTR):
            raise OSError(number, os.strerror(number))
        return 0

    def _received(self, count: int) -> Iterator[Datagram]:
        """The datagrams in the first slots."""
        data, known, learn = self._data, self._senders.get, self._learn
        starts, sizes = range(0, count * _LARGEST, _LARGEST), self._sizes[:count].tolist()
        sources = self._sources[:count].tolist()
        facts = _ANCILLARY.iter_unpack(self._facts[: count * _ANCILLARY.size])
        for start, size, source, (of_time, seconds, rest, of_ttl, ttl) in zip(
            starts, sizes, sources, facts, strict=True
        ):
            payload, sender = data[start : start + size].tobytes(), known(source) or learn(source)
            if of_time == _OF_TIME and of_ttl == _OF_TTL:
                yield payload, sender, seconds * 1_000_000_000 + rest, ttl
            else:  # not this system's
                yield payload, sender, time.time_ns(), None

    def _learn(self, source: int) -> Sender:
        if len(self._senders) >= _MOST_SENDERS:
            self._senders.clear()
        port, address = struct.unpack(">2xH4s", struct.pack("@Q", source))
        sender = self._senders[source] = Sender(socket.inet_ntoa(address), port)
        return sender


def _address(buffer: bytearray) -> int:
    return ctypes.addressof(ctypes.c_char.from_buffer(buffer))
