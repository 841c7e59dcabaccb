"""This computer's UDP sockets by sock_diag(7): receive buffers and lcmtools' marks, on Linux.

One netlink request, answered with every socket of this network namespace; any user may send it.
"""

import contextlib
import socket
import struct
import sys
from collections.abc import Iterator

from lcmtools.bus.kernel import ANNOUNCED, SELECTIVE

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
    """The size of each socket's receive buffer [byte] by its inode; empty where unknown."""
    start = 4 * _RECEIVE_BUFFER
    sizes = {
        inode: int.from_bytes(numbers[start : start + 4], sys.byteorder)
        for inode, numbers in _attributes(_MEMORY)
    }
    return {inode: size for inode, size in sizes.items() if size}


def selective_sockets() -> frozenset[int]:
    """The inodes of ``channel_socket`` sockets, which drop most datagrams on purpose."""
    return _marked(SELECTIVE)


def announced_sockets() -> frozenset[int]:
    """The inodes of the sockets with which lcmtools itself receives; empty where unknown."""
    return _marked(ANNOUNCED, SELECTIVE)


def _marked(*marks: int) -> frozenset[int]:
    return frozenset(
        inode for inode, value in _attributes(_TYPE_OF_SERVICE) if value and value[0] in marks
    )


def _attributes(kind: int) -> Iterator[tuple[int, bytes]]:
    """The inode and the attribute of every socket that has it."""
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
    """The kind and the body of each netlink message in a buffer."""
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
