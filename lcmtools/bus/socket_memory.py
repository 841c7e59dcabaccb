"""How large the receive buffers of UDP sockets are, as the kernel tells everybody on Linux.

By sock_diag(7): a question over netlink, answered with every socket of this network namespace.
"""

import contextlib
import socket
import struct

_NETLINK_SOCK_DIAG = 4
_SOCK_DIAG_BY_FAMILY = 20
_REQUEST_DUMP = 0x301  # NLM_F_REQUEST | NLM_F_DUMP
_DONE, _ERROR = 3, 2
_INET_DIAG_SKMEMINFO = 7
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
    found: dict[int, int] = {}
    if not hasattr(socket, "AF_NETLINK"):
        return found
    with (
        contextlib.suppress(OSError, struct.error),
        socket.socket(socket.AF_NETLINK, socket.SOCK_RAW, _NETLINK_SOCK_DIAG) as kernel,
    ):
        kernel.settimeout(_TIMEOUT)
        request = _REQUEST.pack(
            socket.AF_INET, socket.IPPROTO_UDP, 1 << (_INET_DIAG_SKMEMINFO - 1), 0, _ALL_STATES
        )
        size = _HEADER.size + len(request)
        kernel.send(_HEADER.pack(size, _SOCK_DIAG_BY_FAMILY, _REQUEST_DUMP, 1, 0) + request)
        while _read(kernel.recv(1 << 16), found):
            pass
    return found


def _read(data: bytes, found: dict[int, int]) -> bool:
    """Take the sockets of one answer; whether there are more to come."""
    position = 0
    while position + _HEADER.size <= len(data):
        size, kind, *_ = _HEADER.unpack_from(data, position)
        if kind in (_DONE, _ERROR) or size < _HEADER.size:
            return False
        body = data[position + _HEADER.size : position + size]
        if len(body) >= _MESSAGE_BYTES:
            (inode,) = struct.unpack_from("=I", body, _INODE_OFFSET)
            buffer = _buffer(body)
            if buffer:
                found[inode] = buffer
        position += (size + 3) & ~3
    return bool(data)


def _buffer(body: bytes) -> int:
    position = _MESSAGE_BYTES
    while position + _ATTRIBUTE.size <= len(body):
        size, kind = _ATTRIBUTE.unpack_from(body, position)
        if kind == _INET_DIAG_SKMEMINFO:
            offset = position + _ATTRIBUTE.size + 4 * _RECEIVE_BUFFER
            return int(struct.unpack_from("=I", body, offset)[0])
        if size < _ATTRIBUTE.size:
            break
        position += (size + 3) & ~3
    return 0
