"""Receiving many datagrams from a socket with one call, Linux's recvmmsg(2).

One by one, the calls and Python's objects for ancillary data and addresses take longer than all
further work on the datagrams.
"""

import contextlib
import ctypes
import errno
import mmap
import os
import socket
import struct
import sys
import time
from collections.abc import Iterable, Iterator
from itertools import chain

from lcmtools.bounded import MOST_ENTRIES
from lcmtools.wire.packet import Datagram, Sender

_SLOTS = 64  # datagrams that are taken with one call
_LARGEST = 65536  # bytes of a datagram
_PART = struct.Struct("@PN")  # struct iovec
_HEADER = struct.Struct("@PIPNPNi4xI4x")  # struct mmsghdr
_SIZE = 56  # offset of the datagram's size in it
_ADDRESS_BYTES = 16  # struct sockaddr_in
# the address is followed by two messages of cmsg(3), the time of arrival and the time to live; this
# skips their headers (length, level and type)
_FACTS = struct.Struct("@Q8x16xqq16xi4x")
_KINDS = {  # see kernel.request_arrival; by index among a slot's eight-byte words
    place: struct.unpack("@Q", struct.pack("@ii", *kind))[0]
    for place, kind in {3: (socket.SOL_SOCKET, 35), 7: (socket.IPPROTO_IP, socket.IP_TTL)}.items()
}
_IS_POSSIBLE = sys.platform == "linux" and _HEADER.size == _SIZE + 8


class DatagramBatch:
    """Buffers for the datagrams of a socket with ``kernel.request_arrival``."""

    def __init__(self, receiver: socket.socket) -> None:
        self._receiver = receiver
        self._call = ctypes.PyDLL(None, use_errno=True).recvmmsg  # keeps the lock
        self._senders: dict[int, Sender] = {}
        data = mmap.mmap(-1, _SLOTS * _LARGEST)  # takes memory only where datagrams come
        self._parts, self._headers, self._facts = (
            bytearray(_SLOTS * size) for size in (_PART.size, _HEADER.size, _FACTS.size)
        )
        self._data = memoryview(data)
        buffers = (data, self._parts, self._headers, self._facts)
        cells = (ctypes.c_char.from_buffer(buffer) for buffer in buffers)
        start, parts, headers, facts = map(ctypes.addressof, cells)
        self._start = ctypes.c_void_p(headers)
        fresh = bytearray()
        for slot in range(_SLOTS):
            _PART.pack_into(self._parts, slot * _PART.size, start + slot * _LARGEST, _LARGEST)
            part, source = parts + slot * _PART.size, facts + slot * _FACTS.size
            ends = source + _ADDRESS_BYTES, _FACTS.size - _ADDRESS_BYTES
            fresh += _HEADER.pack(source, _ADDRESS_BYTES, part, 1, *ends, 0, 0)
        self._fresh = bytes(fresh)  # the call writes into the headers
        self._sizes = memoryview(self._headers).cast("I")[_SIZE // 4 :: _HEADER.size // 4]
        self._words = memoryview(self._facts).cast("Q")

    def receive(self, most: int) -> Iterable[Datagram]:
        """Return arrived datagrams, about ``most`` at most, or an iterator over them.

        Raises:
            OSError: The system refuses this call; nothing was read.
        """
        first = self._received(self._receive())
        return first if len(first) < _SLOTS else chain(first, self._more(most - _SLOTS))

    def _more(self, most: int) -> Iterator[Datagram]:
        for _ in range(0, most, _SLOTS):
            count = self._receive()
            yield from self._received(count)
            if count < _SLOTS:
                return

    def _receive(self) -> int:
        self._headers[:] = self._fresh
        number, flags = self._receiver.fileno(), socket.MSG_DONTWAIT
        count: int = self._call(number, self._start, _SLOTS, flags, None)
        if count >= 0:
            return count
        if (fault := ctypes.get_errno()) not in (errno.EAGAIN, errno.EINTR):
            raise OSError(fault, os.strerror(fault))
        return 0

    def _received(self, count: int) -> list[Datagram]:
        data, known, add = self._data, self._senders.get, self._add_sender
        facts = _FACTS.iter_unpack(memoryview(self._facts)[: count * _FACTS.size])
        has_time, has_ttl = (self._words[place] == kind for place, kind in _KINDS.items())
        now, places = time.time_ns(), range(0, count * _LARGEST, _LARGEST)
        slots = zip(places, self._sizes[:count].tolist(), facts, strict=True)
        return [
            (
                data[at : at + size].tobytes(),
                known(source) or add(source),
                seconds * 1_000_000_000 + rest if has_time else now,
                ttl if has_ttl else None,
            )
            for at, size, (source, seconds, rest, ttl) in slots
        ]

    def _add_sender(self, source: int) -> Sender:
        if len(self._senders) >= MOST_ENTRIES:
            self._senders.clear()
        port, address = struct.unpack(">2xH4s", struct.pack("@Q", source))
        sender = self._senders[source] = Sender(socket.inet_ntoa(address), port)
        return sender


def batch_of(receiver: socket.socket) -> DatagramBatch | None:
    """Return the buffers for a socket; None if the system has no such call, or no memory for it."""
    with contextlib.suppress(OSError, AttributeError, MemoryError):
        return DatagramBatch(receiver) if _IS_POSSIBLE else None
    return None
