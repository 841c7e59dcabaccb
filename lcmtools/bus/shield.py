"""A filter in the kernel that keeps malformed datagrams from liblcm, which can crash on them.

liblcm trusts what it receives: a datagram that ends before its channel's name does makes it read
what another message left in the same buffer, and the process may die. Linux lets a program attach
a filter to a socket (classic BPF, socket(7) SO_ATTACH_FILTER), which runs before a datagram is
queued. It is built here; elsewhere than on Linux there is none, and liblcm takes its chances.

The filter accepts what ``lcmtools.wire.datagram.parse`` accepts, but for an empty channel name.
"""

import contextlib
import ctypes
import os
import socket
import stat
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from lcmtools.bus.url import BusUrl
from lcmtools.wire.datagram import MAGIC_FRAGMENT, MAGIC_SHORT, MESSAGE_MAX

_SO_ATTACH_FILTER = 26  # asm-generic/socket.h
_UDP_HEADER = 8  # a UDP socket's filter sees it before the datagram
_CHANNEL = 63  # bytes of a channel's name at most

# Operations of classic BPF (linux/bpf_common.h): A is the accumulator, X the index register.
_LOAD_WORD, _LOAD_HALF, _LOAD_BYTE, _LOAD_LENGTH = 0x20, 0x28, 0x30, 0x80
_LOAD_X, _TO_X, _ADD_X, _SUB, _SUB_X = 0x01, 0x07, 0x0C, 0x14, 0x1C
_JUMP, _JUMP_EQUAL, _JUMP_GREATER, _JUMP_GREATER_EQUAL_X = 0x05, 0x15, 0x25, 0x3D
_RETURN = 0x06


@dataclass(frozen=True, slots=True)
class Instruction:
    """One instruction; jumps are relative to the next one."""

    code: int
    k: int = 0
    if_true: int = 0
    if_false: int = 0

    def pack(self) -> bytes:
        """As the kernel takes it (struct sock_filter)."""
        return struct.pack("=HBBI", self.code, self.if_true, self.if_false, self.k)


_ACCEPT = Instruction(_RETURN, 0xFFFFFFFF)
_DROP = Instruction(_RETURN, 0)


def protect(url: BusUrl, known: set[int]) -> None:
    """Attach the filter to the sockets of this process that listen to the bus.

    Args:
        url: A multicast bus.
        known: File descriptors that are not liblcm's, and stay as they are.
    """
    program = b"".join(instruction.pack() for instruction in filter_program())
    code = ctypes.create_string_buffer(program, len(program))
    # struct sock_fprog: the number of instructions and where they are
    argument = struct.pack("@HP", len(program) // 8, ctypes.addressof(code))
    for descriptor in filter(_is_socket, open_descriptors() - known):
        # a duplicate, because closing the Python object must not close liblcm's socket
        with socket.socket(fileno=os.dup(descriptor)) as listener, contextlib.suppress(OSError):
            if listener.getsockname() == (url.host, url.port):
                listener.setsockopt(socket.SOL_SOCKET, _SO_ATTACH_FILTER, argument)


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
    short = [*_find_channel_end(_UDP_HEADER + 8), _ACCEPT]
    fragment = list(_check_fragment(_UDP_HEADER))
    return [
        Instruction(_LOAD_WORD, _UDP_HEADER),
        Instruction(_JUMP_EQUAL, int.from_bytes(MAGIC_FRAGMENT, "big"), 0, 1),
        Instruction(_JUMP, 2 + len(short)),
        Instruction(_JUMP_EQUAL, int.from_bytes(MAGIC_SHORT, "big"), 1, 0),
        _DROP,
        *short,
        *fragment,
    ]


def _find_channel_end(start: int) -> Iterator[Instruction]:
    """Find the NUL behind a name of 1 to 63 bytes, and go on with X = the bytes it all takes."""
    yield Instruction(_LOAD_BYTE, start)
    yield Instruction(_JUMP_EQUAL, 0, 0, 1)
    yield _DROP
    for size in range(1, _CHANNEL + 1):
        yield Instruction(_LOAD_BYTE, start + size)
        yield Instruction(_JUMP_EQUAL, 0, 0, 2)
        yield Instruction(_LOAD_X, size + 1)
        yield Instruction(_JUMP, 4 * (_CHANNEL - size) + 1)
    yield _DROP


def _check_fragment(start: int) -> Iterator[Instruction]:
    """A fragment's number is below their count, and it lies within its message."""
    size, offset, number, count, rest = start + 8, start + 12, start + 16, start + 18, start + 20
    channel = list(_find_channel_end(rest))
    yield Instruction(_LOAD_HALF, count)
    yield Instruction(_TO_X)
    yield Instruction(_LOAD_HALF, number)
    yield Instruction(_JUMP_GREATER_EQUAL_X, 0, 0, 1)
    yield _DROP
    for position in (size, offset):
        yield Instruction(_LOAD_WORD, position)
        yield Instruction(_JUMP_GREATER, MESSAGE_MAX, 0, 1)
        yield _DROP
    yield Instruction(_LOAD_X, 0)
    yield Instruction(_LOAD_HALF, number)
    yield Instruction(_JUMP_EQUAL, 0, 1, 0)
    yield Instruction(_JUMP, len(channel))
    yield from channel
    yield Instruction(_LOAD_LENGTH)
    yield Instruction(_SUB, rest)
    yield Instruction(_SUB_X)
    yield Instruction(_TO_X)
    yield Instruction(_LOAD_WORD, offset)
    yield Instruction(_ADD_X)
    yield Instruction(_TO_X)
    yield Instruction(_LOAD_WORD, size)
    yield Instruction(_JUMP_GREATER_EQUAL_X, 0, 1, 0)
    yield _DROP
    yield _ACCEPT
