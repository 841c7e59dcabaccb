"""A mailbox: one channel's messages wait in the kernel until somebody looks.

To be woken for each message costs far more than to read many at once. A mailbox is a socket of its
own in the group, before which a filter in the kernel (Linux only) lets nothing but one channel
through. It is for small messages that may be read a little later: of what does not fit into the
socket's buffer between two looks, the newest are lost.
"""

import contextlib
from collections.abc import Iterator

from lcmtools.bus.arrival import ANCILLARY_BYTES, ask_kernel, told
from lcmtools.bus.marks import SELECTIVE, mark
from lcmtools.bus.multicast import receiving_socket
from lcmtools.bus.socket_filter import (
    ACCEPT,
    DROP,
    JUMP_EQUAL,
    LOAD_BYTE,
    LOAD_HALF,
    LOAD_WORD,
    UDP_HEADER,
    Instruction,
    attach,
)
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.wire.datagram import FRAGMENT_HEADER_BYTES, MAGIC_FRAGMENT, MAGIC_SHORT

_SHORT_HEADER_BYTES = 8
_NUMBER_OFFSET = 16  # of a fragment's number
_MAX_DATAGRAM = 65536
_MOST_AT_ONCE = 4096  # messages: a flood must not keep who looks
_LOADS = {4: LOAD_WORD, 2: LOAD_HALF, 1: LOAD_BYTE}


class ChannelSocket:
    """Takes the messages of one channel of a multicast bus, from now on.

    ``take`` never blocks; use it from one thread at a time.

    Args:
        url: The bus.
        channel: The channel.

    Raises:
        BusError: The group cannot be joined, or this system has no such filter.
    """

    def __init__(self, url: BusUrl, channel: str) -> None:
        self._name = channel.encode() + b"\0"
        self.has_large = False
        """Whether a message came that fills several datagrams: those cannot be had here."""
        self._buffer = memoryview(bytearray(_MAX_DATAGRAM))
        self._receiver = receiving_socket(url)
        self._receiver.setblocking(False)  # noqa: FBT003 - socket's signature
        if not attach(self._receiver, one_channel(channel)):
            self._receiver.close()
            raise BusError("this system cannot filter datagrams")
        ask_kernel(self._receiver)
        mark(self._receiver, SELECTIVE)

    def take(self) -> list[tuple[bytes, int]]:
        """The payloads that have come, each with when it did [ns since 1970], the oldest first.

        Nothing when it is closed.
        """
        taken: list[tuple[bytes, int]] = []
        start = _SHORT_HEADER_BYTES + len(self._name)
        with contextlib.suppress(OSError):  # BlockingIOError: that was all
            for _ in range(_MOST_AT_ONCE):
                size, ancillary, *_ = self._receiver.recvmsg_into([self._buffer], ANCILLARY_BYTES)
                data = bytes(self._buffer[:size])
                # compared once more: what came before the filter stood is anything
                if data.startswith(MAGIC_SHORT) and data[_SHORT_HEADER_BYTES:start] == self._name:
                    taken.append((data[start:], told(ancillary)[0]))
                elif data.startswith(MAGIC_FRAGMENT) and self._begins_large(data):
                    self.has_large = True
        return taken

    def close(self) -> None:
        """Leave the group."""
        self._receiver.close()

    def _begins_large(self, fragment: bytes) -> bool:
        is_first = fragment[_NUMBER_OFFSET : _NUMBER_OFFSET + 2] == b"\0\0"
        return is_first and fragment.startswith(self._name, FRAGMENT_HEADER_BYTES)


def one_channel(channel: str) -> list[Instruction]:
    """The filter that lets pass a channel's messages, and of large ones the first fragment."""
    name = channel.encode() + b"\0"
    short = [*_is_at(UDP_HEADER + _SHORT_HEADER_BYTES, name), ACCEPT]
    return [
        Instruction(LOAD_WORD, UDP_HEADER),
        Instruction(JUMP_EQUAL, int.from_bytes(MAGIC_SHORT, "big"), 0, len(short)),
        *short,
        Instruction(JUMP_EQUAL, int.from_bytes(MAGIC_FRAGMENT, "big"), 1, 0),
        DROP,
        *_is_at(UDP_HEADER + _NUMBER_OFFSET, b"\0\0"),
        *_is_at(UDP_HEADER + FRAGMENT_HEADER_BYTES, name),
        ACCEPT,
    ]


def _is_at(position: int, expected: bytes) -> Iterator[Instruction]:
    """Go on where these bytes stand at a position; drop what has others."""
    while expected:
        size = next(size for size in _LOADS if size <= len(expected))
        yield Instruction(_LOADS[size], position)
        yield Instruction(JUMP_EQUAL, int.from_bytes(expected[:size], "big"), 1, 0)
        yield DROP
        position, expected = position + size, expected[size:]
