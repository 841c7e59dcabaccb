"""A filter in the kernel that keeps malformed datagrams from liblcm, which can crash on them.

liblcm trusts what it receives: a datagram that ends before its channel's name does makes it read
what another message left in the same buffer, and the process may die. Linux lets a program attach
a filter to a socket (classic BPF, socket(7) SO_ATTACH_FILTER), which runs before a datagram is
queued. It is built here; elsewhere than on Linux there is none, and liblcm takes its chances.

The filter accepts what ``lcmtools.wire.datagram.parse`` accepts, but for an empty channel name.
"""

import contextlib
import os
import socket
import stat
from collections.abc import Iterator
from pathlib import Path

from lcmtools.bus.marks import ANNOUNCED, mark
from lcmtools.bus.socket_filter import (
    ACCEPT,
    ADD_X,
    DROP,
    JUMP,
    JUMP_EQUAL,
    JUMP_GREATER,
    JUMP_GREATER_EQUAL_X,
    LOAD_BYTE,
    LOAD_HALF,
    LOAD_LENGTH,
    LOAD_WORD,
    LOAD_X,
    SUB,
    SUB_X,
    TO_X,
    UDP_HEADER,
    Instruction,
    attach,
)
from lcmtools.bus.url import BusUrl
from lcmtools.wire.datagram import MAGIC_FRAGMENT, MAGIC_SHORT, MESSAGE_MAX

_CHANNEL = 63  # bytes of a channel's name at most


def protect(url: BusUrl, known: set[int]) -> None:
    """Attach the filter to the sockets of this process that listen to the bus, and mark them.

    Args:
        url: A multicast bus.
        known: File descriptors that are not liblcm's, and stay as they are.
    """
    program = filter_program()
    for descriptor in filter(_is_socket, open_descriptors() - known):
        # a duplicate, because closing the Python object must not close liblcm's socket
        with socket.socket(fileno=os.dup(descriptor)) as listener, contextlib.suppress(OSError):
            if listener.getsockname() == (url.host, url.port):
                attach(listener, program)
                mark(listener, ANNOUNCED)


def open_descriptors() -> set[int]:
    """The file descriptors of this process; empty where the system does not tell."""
    try:
        return {int(entry.name) for entry in Path("/proc/self/fd").iterdir()}
    except OSError:
        return set()


def _is_socket(descriptor: int) -> bool:
    try:
        return stat.S_ISSOCK(os.fstat(descriptor).st_mode)
    except OSError:  # closed meanwhile
        return False


def filter_program() -> list[Instruction]:
    """The filter. A load from beyond the datagram's end drops it, as the kernel has it."""
    short = [*_find_channel_end(UDP_HEADER + 8), ACCEPT]
    fragment = list(_check_fragment(UDP_HEADER))
    return [
        Instruction(LOAD_WORD, UDP_HEADER),
        Instruction(JUMP_EQUAL, int.from_bytes(MAGIC_FRAGMENT, "big"), 0, 1),
        Instruction(JUMP, 2 + len(short)),
        Instruction(JUMP_EQUAL, int.from_bytes(MAGIC_SHORT, "big"), 1, 0),
        DROP,
        *short,
        *fragment,
    ]


def _find_channel_end(start: int) -> Iterator[Instruction]:
    """Find the NUL behind a name of 1 to 63 bytes, and go on with X = the bytes it all takes."""
    yield Instruction(LOAD_BYTE, start)
    yield Instruction(JUMP_EQUAL, 0, 0, 1)
    yield DROP
    for size in range(1, _CHANNEL + 1):
        yield Instruction(LOAD_BYTE, start + size)
        yield Instruction(JUMP_EQUAL, 0, 0, 2)
        yield Instruction(LOAD_X, size + 1)
        yield Instruction(JUMP, 4 * (_CHANNEL - size) + 1)
    yield DROP


def _check_fragment(start: int) -> Iterator[Instruction]:
    """A fragment's number is below their count, and it lies within its message."""
    size, offset, number, count, rest = start + 8, start + 12, start + 16, start + 18, start + 20
    channel = list(_find_channel_end(rest))
    yield Instruction(LOAD_HALF, count)
    yield Instruction(TO_X)
    yield Instruction(LOAD_HALF, number)
    yield Instruction(JUMP_GREATER_EQUAL_X, 0, 0, 1)
    yield DROP
    for position in (size, offset):
        yield Instruction(LOAD_WORD, position)
        yield Instruction(JUMP_GREATER, MESSAGE_MAX, 0, 1)
        yield DROP
    yield Instruction(LOAD_X, 0)
    yield Instruction(LOAD_HALF, number)
    yield Instruction(JUMP_EQUAL, 0, 1, 0)
    yield Instruction(JUMP, len(channel))
    yield from channel
    yield Instruction(LOAD_LENGTH)
    yield Instruction(SUB, rest)
    yield Instruction(SUB_X)
    yield Instruction(TO_X)
    yield Instruction(LOAD_WORD, offset)
    yield Instruction(ADD_X)
    yield Instruction(TO_X)
    yield Instruction(LOAD_WORD, size)
    yield Instruction(JUMP_GREATER_EQUAL_X, 0, 1, 0)
    yield DROP
    yield ACCEPT
