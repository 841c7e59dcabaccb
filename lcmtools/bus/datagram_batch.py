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
from array import array
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
# the time to live; that is words of eight bytes
_ANCILLARY = struct.Struct("@Nii2qNiii0N")
_SECONDS, _FRACTION, _TTL = 2, 3, 6  # places among these words
_KINDS = {  # see kernel.request_arrival
    place: struct.unpack("@Q", struct.pack("@ii", *kind))[0]
    for place, kind in {1: (socket.SOL_SOCKET, 35), 5: (socket.IPPROTO_IP, socket.IP_TTL)}.items()
}
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
        words = memoryview(ancillary).cast("Q")
        self._kinds = {at: memoryview(array("Q", [kind] * _SLOTS)) for at, kind in _KINDS.items()}
        self._facts = [words[place :: _ANCILLARY.size // 8] for place in range(_TTL)]
        self._ttls = words.cast("B").cast("I")[2 * _TTL :: _ANCILLARY.size // 4]

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
        """The datagrams in the first slots: column by column, which takes a third of the time."""
        starts, data, facts = range(0, count * _LARGEST, _LARGEST), self._data, self._facts
        sizes = self._sizes[:count].tolist()
        payloads = [data[at : at + size].tobytes() for at, size in zip(starts, sizes, strict=True)]
        known, learn = self._senders.get, self._learn
        senders = [known(one) or learn(one) for one in self._sources[:count].tolist()]
        if any(facts[at][:count] != kinds[:count] for at, kinds in self._kinds.items()):
            others = [time.time_ns()] * count, [None] * count  # not this system's
            return zip(payloads, senders, *others, strict=True)
        seconds, fractions = (facts[at][:count].tolist() for at in (_SECONDS, _FRACTION))
        times = [one * 1_000_000_000 + rest for one, rest in zip(seconds, fractions, strict=True)]
        return zip(payloads, senders, times, self._ttls[:count].tolist(), strict=True)

    def _learn(self, source: int) -> Sender:
        if len(self._senders) >= _MOST_SENDERS:
            self._senders.clear()
        port, address = struct.unpack(">2xH4s", struct.pack("@Q", source))
        sender = self._senders[source] = Sender(socket.inet_ntoa(address), port)
        return sender


def _address(buffer: bytearray) -> int:
    return ctypes.addressof(ctypes.c_char.from_buffer(buffer))
