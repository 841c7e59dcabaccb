"""What the kernel tells everybody of this computer's UDP sockets beyond /proc, on Linux.

How large their receive buffers are, and how lcmtools has marked them. By sock_diag(7):
a question over netlink, answered with every socket of this network namespace.
"""

import contextlib
import socket
import struct
import sys
from collections.abc import Iterator

from lcmtools.bus.marks import ANNOUNCED, SELECTIVE

_NETLINK_SOCK_DIAG = 4
_SOCK_DIAG_BY_FAMILY = 20
_REQUEST_DUMP = 0x301  # NLM_F_REQUEST | NLM_F_DUMP
_DONE, _ERROR = 3, 2
_TYPE_OF_SERVICE, _MEMORY = 5, 7  # INET_DIAG_TOS, INET_DIAG_SKMEMINFO
_ALL_STATES = 0xFFFFFFFF
_HEADER = struct.Struct("=IHHII")  # struct nlmsghdr
_REQUEST = struct.Struct("=BBBBI48x")  # struct inet_diag_req_v2
_MESSAGE_BYTES = 72  # of struct inet_diag_msg
_INODE_OFFSET = 68  # in it
_ATTRIBUTE = struct.Struct("=HH")
_RECEIVE_BUFFER = 1  # its place among the numbers (linux/sock_diag.h)
_TIMEOUT = 0.2  # [s]


def receive_buffers() -> dict[int, int]:
    """The size of the receive buffer [byte] by the socket's inode; empty where nobody tells."""
    start = 4 * _RECEIVE_BUFFER
    told = _told_of_sockets(_MEMORY)
    sizes = {
        inode: int.from_bytes(numbers[start : start + 4], sys.byteorder) for inode, numbers in told
    }
    return {inode: size for inode, size in sizes.items() if size}


def selective_sockets() -> frozenset[int]:
    """The inodes of the sockets whose filter drops most of what comes, on purpose.

    Those of lcmtools.bus.channel_socket; empty where nobody tells.
    """
    return _marked(SELECTIVE)


def announced_sockets() -> frozenset[int]:
    """The inodes of the sockets with which lcmtools itself hears; empty where nobody tells."""
    return _marked(ANNOUNCED, SELECTIVE)


def _marked(*marks: int) -> frozenset[int]:
    told = _told_of_sockets(_TYPE_OF_SERVICE)
    return frozenset(inode for inode, value in told if value[:1] in map(_byte, marks))


def _byte(number: int) -> bytes:
    return bytes([number])


def _told_of_sockets(kind: int) -> Iterator[tuple[int, bytes]]:
    """An attribute of every socket that has it, with the socket's inode."""
    if not hasattr(socket, "AF_NETLINK"):
        return
    with (
        contextlib.suppress(OSError, struct.error),
        socket.socket(socket.AF_NETLINK, socket.SOCK_RAW, _NETLINK_SOCK_DIAG) as kernel,
    ):
        kernel.settimeout(_TIMEOUT)
        request = _REQUEST.pack(socket.AF_INET, socket.IPPROTO_UDP, 1 << (kind - 1), 0, _ALL_STATES)
        size = _HEADER.size + len(request)
        kernel.send(_HEADER.pack(size, _SOCK_DIAG_BY_FAMILY, _REQUEST_DUMP, 1, 0) + request)
        while data := kernel.recv(1 << 16):
            for answer, body in _answers(data):
                if answer in (_DONE, _ERROR):
                    return
                value = _attribute(body, kind)
                if value is not None:
                    (inode,) = struct.unpack_from("=I", body, _INODE_OFFSET)
                    yield inode, value


def _answers(data: bytes) -> Iterator[tuple[int, bytes]]:
    """The messages that came together: what each is, and what follows its header."""
    position = 0
    while position + _HEADER.size <= len(data):
        size, kind, *_ = _HEADER.unpack_from(data, position)
        if size < _HEADER.size:
            yield _ERROR, b""
            return
        yield kind, data[position + _HEADER.size : position + size]
        position += (size + 3) & ~3


def _attribute(body: bytes, wanted: int) -> bytes | None:
    position = _MESSAGE_BYTES
    while position + _ATTRIBUTE.size <= len(body):
        size, kind = _ATTRIBUTE.unpack_from(body, position)
        if kind == wanted:
            return body[position + _ATTRIBUTE.size : position + size]
        if size < _ATTRIBUTE.size:
            break
        position += (size + 3) & ~3
    return None
