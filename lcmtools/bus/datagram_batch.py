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

from lcmtools.wire.packet import Sender

_SLOTS = 64  # datagrams that are taken with one call
_LARGEST = 65536  # bytes of a datagram
_PART = struct.Struct("@PN")  # struct iovec
_HEADER = struct.Struct("@PIPNPNi4xI4x")  # struct mmsghdr
_SIZE = 56  # the place in it of the datagram's size
_ADDRESS = struct.Struct("16s")  # struct sockaddr_in
# two messages of cmsg(3), each with length, level and type: the arrival's time, of two numbers, and
# the time to live
_ANCILLARY = struct.Struct("@Nii2qNiii0N")
_KINDS = socket.SOL_SOCKET, 35, socket.IPPROTO_IP, socket.IP_TTL  # see kernel.request_arrival
_MOST_SENDERS = 1000  # that are remembered
IS_POSSIBLE = sys.platform == "linux" and _HEADER.size == _SIZE + 8


class DatagramBatch:
    """Buffers for the datagrams of a socket with ``kernel.request_arrival``."""

    def __init__(self, receiver: socket.socket) -> None:
        self._receiver = receiver
        self._call = ctypes.CDLL(None, use_errno=True).recvmmsg
        self._senders: dict[bytes, Sender] = {}
        data, self._parts, self._headers, self._addresses, self._ancillary = (
            bytearray(_SLOTS * size)
            for size in (_LARGEST, _PART.size, _HEADER.size, _ADDRESS.size, _ANCILLARY.size)
        )
        self._data = memoryview(data)
        start, parts, headers, addresses, ancillary = map(
            _address, (data, self._parts, self._headers, self._addresses, self._ancillary)
        )
        self._start = ctypes.c_void_p(headers)
        fresh = bytearray()
        for slot in range(_SLOTS):
            _PART.pack_into(self._parts, slot * _PART.size, start + slot * _LARGEST, _LARGEST)
            address, part = addresses + slot * _ADDRESS.size, parts + slot * _PART.size
            ends = ancillary + slot * _ANCILLARY.size, _ANCILLARY.size
            fresh += _HEADER.pack(address, _ADDRESS.size, part, 1, *ends, 0, 0)
        self._fresh = bytes(fresh)  # the call writes into the headers
        self._sizes = memoryview(self._headers).cast("I")[_SIZE // 4 :: _HEADER.size // 4]

    def take(self, most: int) -> Iterator[tuple[bytes, Sender, int, int | None]]:
        """Yield those that have arrived: data, sender, time [ns since 1970], time to live.

        Raises:
            OSError: As of recvmsg(2).
        """
        count = _SLOTS
        for _ in range(0, most, _SLOTS):
            if count == _SLOTS:
                count = self._receive()
                yield from self._received(count)

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

    def _received(self, count: int) -> Iterator[tuple[bytes, Sender, int, int | None]]:
        sources, known = _ADDRESS.iter_unpack(self._addresses), self._senders
        starts = range(0, count * _LARGEST, _LARGEST)
        facts = _ANCILLARY.iter_unpack(self._ancillary)
        for start, size, (source,), fact in zip(starts, self._sizes, sources, facts, strict=False):
            _, level, kind, seconds, fraction, _, other_level, other_kind, ttl = fact
            if (level, kind, other_level, other_kind) != _KINDS:
                seconds, fraction, ttl = 0, time.time_ns(), None
            yield (
                self._data[start : start + size].tobytes(),
                known.get(source) or self._learn(source),
                seconds * 1_000_000_000 + fraction,
                ttl,
            )

    def _learn(self, source: bytes) -> Sender:
        if len(self._senders) >= _MOST_SENDERS:
            self._senders.clear()
        port, address = struct.unpack_from(">2xH4s", source)
        sender = self._senders[source] = Sender(socket.inet_ntoa(address), port)
        return sender


def _address(buffer: bytearray) -> int:
    return ctypes.addressof(ctypes.c_char.from_buffer(buffer))
