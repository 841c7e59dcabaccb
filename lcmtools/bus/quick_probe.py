"""A glance at a bus: what can be known of it within some hundredths of a second.

Shell completion stands on it. The question to the nodes leaves at once, and the answers wait in
the socket while the caller does something else; ``graph`` reads them. On Linux a filter in the
kernel lets only announcements through whole: of other messages the first bytes, so that a bus full
of images cannot crowd the answers out.
"""

import contextlib
import select
import socket
import struct
import time
from array import array
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from lcmtools.bus.multicast import receiving_socket, sending_socket
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError

if TYPE_CHECKING:  # imported while the answers are on their way
    from lcmtools.graph.builder import GraphBuilder
    from lcmtools.graph.model import Graph
    from lcmtools.graph.protocol import Announcement

PROBE = (
    b"LC02\0\0\0\0/_lcmtools/probe\0\x36\xa8\xcc\x66\xfe\xbe\x4d\xc8\0\0\0\x01\0\0\0\0\0\0\0\0\0"
)
"""The datagram that asks all nodes to announce themselves, as ``graph.protocol`` would make it.

It leaves before anything is imported that could: importing takes longer than answering.
"""
AT_LEAST = 0.03
"""Nodes have so many seconds to answer, three times what they need."""
AT_MOST = 0.08
"""A node that is known to run is waited for so many seconds: on a busy computer it may be late."""
_QUIET = 0.012  # [s] without an announcement after which the answers count as complete
_MAX_DATAGRAM = 65536
_SO_ATTACH_FILTER = 26  # asm-generic/socket.h

# Classic BPF; offsets count from the UDP header of 8 bytes (see lcmtools.bus.datagram_filter)
_LOAD_WORD, _LOAD_HALF, _JUMP_EQUAL, _RETURN = 0x20, 0x28, 0x15, 0x06
_OWN = -1
_HEAD_BYTES = 8 + 20 + 64 + 8  # up to the fingerprint of a message with the longest channel
_FILTER = (  # operation, jump if true, jump if false, operand; _OWN is replaced
    (_LOAD_WORD, 0, 0, 8),
    (_JUMP_EQUAL, 0, 2, int.from_bytes(b"LC02", "big")),
    (_LOAD_WORD, 0, 0, 16),
    (_JUMP_EQUAL, 5, 4, _OWN),  # as the channels of answers begin
    (_JUMP_EQUAL, 0, 2, int.from_bytes(b"LC03", "big")),
    (_LOAD_HALF, 0, 0, 24),
    (_JUMP_EQUAL, 1, 0, 0),  # the first fragment of a large message has the channel
    (_RETURN, 0, 0, 0),
    (_RETURN, 0, 0, _HEAD_BYTES),
    (_RETURN, 0, 0, 0xFFFFFFFF),
)


class QuickProbe:
    """A question to the nodes of a multicast bus, sent when this is made.

    Args:
        url: The bus.
        question: The datagram that asks; without it all nodes are asked to announce themselves.
        answers_on: The channel on which the answers come.

    Raises:
        BusError: The bus is no multicast, or cannot be reached.
    """

    def __init__(
        self, url: BusUrl, question: bytes = PROBE, answers_on: str = "/_lcmtools/node"
    ) -> None:
        if not url.is_multicast:
            raise BusError("only a multicast bus can be glanced at")
        self._receiver = receiving_socket(url)
        self._receiver.setblocking(False)  # noqa: FBT003 - socket's signature
        _let_heads_through(self._receiver, answers_on)
        self._sender = sending_socket(url)
        try:
            self._sender.sendto(question, (url.host, url.port))
        except OSError as error:
            self.close()
            raise BusError(f"cannot send to {url.host}: {error.strerror}") from error
        self._asked = time.monotonic()

    def __enter__(self) -> "QuickProbe":
        """Use the glance as a context manager."""
        return self

    def __exit__(self, *_: object) -> None:
        """Leave the bus."""
        self.close()

    def close(self) -> None:
        """Leave the bus."""
        self._receiver.close()
        self._sender.close()

    def graph(self, expected: Iterable[str] = ()) -> "Graph":
        """What has been answered and heard, complete where nodes answer as fast as they should.

        Args:
            expected: Ids of nodes that are known to run: they are waited for, up to AT_MOST.
        """
        from lcmtools.graph.builder import GraphBuilder

        builder, missing = GraphBuilder(), set(expected)
        soonest, latest = self._asked + AT_LEAST, self._asked + AT_MOST
        while (now := time.monotonic()) < latest and (missing or now < soonest):
            answered = self._read(builder, min(_QUIET, latest - now))
            if answered:
                missing -= answered
                soonest = max(soonest, time.monotonic() + _QUIET)
        self._read(builder, 0.0)  # where this process itself was held up, what came meanwhile
        return builder.snapshot(time.time_ns())

    def replies(self, channel: str, deadline: float) -> Iterator[bytes]:
        """The payloads that come on a channel until the deadline [s of ``time.monotonic``]."""
        from lcmtools.wire.datagram import ShortMessage, parse

        while (left := deadline - time.monotonic()) > 0:
            if select.select([self._receiver], [], [], left)[0]:
                message = parse(self._receiver.recv(_MAX_DATAGRAM))
                if isinstance(message, ShortMessage) and message.channel == channel:
                    yield message.payload

    def _read(self, builder: "GraphBuilder", timeout: float) -> set[str]:
        """Take what has arrived; the ids of nodes that were among it."""
        if not select.select([self._receiver], [], [], timeout)[0]:
            return set()
        until = time.monotonic() + _QUIET
        answered: set[str] = set()
        with contextlib.suppress(BlockingIOError):
            while time.monotonic() < until:
                data, address = self._receiver.recvfrom(_MAX_DATAGRAM)
                announcement = _learn(builder, data, address)
                if announcement is not None:
                    answered.add(announcement.node.id)
        return answered


def _learn(builder: "GraphBuilder", data: bytes, address: tuple[str, int]) -> "Announcement | None":
    """Learn from one datagram, perhaps only the head of one; the announcement if it is one."""
    from lcmtools.wire.datagram import Fragment, ShortMessage, parse
    from lcmtools.wire.packet import Packet, Sender

    message = parse(data)
    if isinstance(message, ShortMessage):
        payload = message.payload
    elif isinstance(message, Fragment):
        payload = message.part
    else:
        return None
    if message.channel is None:
        return None
    return builder.hear(Packet(message.channel, payload, time.time_ns(), Sender(*address)))


def _let_heads_through(receiver: socket.socket, answers_on: str) -> None:
    own = int.from_bytes(answers_on.encode()[:4].ljust(4, b"\0"), "big")
    rows = (struct.pack("=HBBI", *one[:3], own if one[3] == _OWN else one[3]) for one in _FILTER)
    program = array("B", b"".join(rows))
    fprog = struct.pack("@HP", len(_FILTER), program.buffer_info()[0])  # struct sock_fprog
    with contextlib.suppress(OSError):  # not Linux: everything comes whole
        receiver.setsockopt(socket.SOL_SOCKET, _SO_ATTACH_FILTER, fprog)
