"""Filters in the kernel (classic BPF, socket(7) SO_ATTACH_FILTER), which only Linux has.

A filter is a small program that sees each datagram, after its UDP header, before it is queued; it
returns how many bytes of it are kept, UDP header included, 0 for none. A load from beyond the end
drops the datagram. Belongs here: instructions, and how a socket gets a program.
"""

import socket
import struct
from array import array
from collections.abc import Sequence
from dataclasses import dataclass

UDP_HEADER = 8
"""Bytes that a UDP socket's filter sees before the datagram."""

# Operations (linux/bpf_common.h): A is the accumulator, X the index register.
LOAD_WORD, LOAD_HALF, LOAD_BYTE, LOAD_LENGTH = 0x20, 0x28, 0x30, 0x80
LOAD_X, TO_X, ADD_X, SUB, SUB_X = 0x01, 0x07, 0x0C, 0x14, 0x1C
JUMP, JUMP_EQUAL, JUMP_GREATER, JUMP_GREATER_EQUAL, JUMP_GREATER_EQUAL_X = 5, 0x15, 0x25, 0x35, 0x3D
RETURN = 0x06

_SO_ATTACH_FILTER = 26  # asm-generic/socket.h


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


ACCEPT = Instruction(RETURN, 0xFFFFFFFF)
DROP = Instruction(RETURN, 0)


def attach(receiver: socket.socket, program: Sequence[Instruction]) -> bool:
    """Put a filter before a socket; False where the system has no such thing."""
    code = array("B", b"".join(instruction.pack() for instruction in program))
    # struct sock_fprog: the number of instructions and where they are
    argument = struct.pack("@HP", len(program), code.buffer_info()[0])
    try:
        receiver.setsockopt(socket.SOL_SOCKET, _SO_ATTACH_FILTER, argument)
    except OSError:
        return False
    return True
