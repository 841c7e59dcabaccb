"""A quick probe of a bus, which gets its graph within hundredths of a second, for shell completion.

The constructor sends the probe, and the answers wait in the socket until ``graph`` reads them. On
Linux a filter in the kernel keeps only the head of other messages, so that a bus full of images
cannot crowd the answers out.
"""

import contextlib
import select
import time
from collections.abc import Callable, Container, Iterable, Iterator
from typing import TYPE_CHECKING

from lcmtools.bus.multicast import receiving_socket, send_to_group, sending_socket
from lcmtools.bus.socket_filter import whole_on
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError, os_errors_as

if TYPE_CHECKING:  # at run time imported later, while answers are on their way
    from lcmtools.graph.builder import GraphBuilder
    from lcmtools.graph.model import Graph

PROBE_CHANNEL = "/_lcmtools/probe"
PROBE_PAYLOAD = b"\x36\xa8\xcc\x66\xfe\xbe\x4d\xc8\0\0\0\x01\0\0\0\0\0\0\0\0\0"
PROBE = b"LC02\0\0\0\0" + PROBE_CHANNEL.encode() + b"\0" + PROBE_PAYLOAD
"""The datagram that requests all nodes' announcements, as ``graph.protocol`` encodes it.

A constant, because importing the encoder takes longer than the answers.
"""
AT_LEAST = 0.03  # time that nodes have to answer [s], three times as long as they need
AT_MOST = 0.08  # the same for a node that is known to run [s]: on a busy computer it may be late
_QUIET = 0.012  # [s] without an announcement after which the answers count as complete
_MAX_DATAGRAM = 65536


class QuickProbe(contextlib.AbstractContextManager["QuickProbe"]):
    """A request to the nodes of a multicast bus, sent by the constructor.

    By default it requests all nodes' announcements; answers arrive on a channel.

    Raises:
        BusError: The bus is not multicast, or cannot be reached.
    """

    def __init__(
        self, url: BusUrl, request: bytes = PROBE, answers_on: str = "/_lcmtools/node"
    ) -> None:
        if not url.is_multicast:
            raise BusError("only a multicast bus can be probed")
        is_sent = os_errors_as(f"cannot send to {url.host}", kind=BusError)
        with contextlib.ExitStack() as opened, is_sent:
            self._receiver = opened.enter_context(
                receiving_socket(url, whole_on(answers_on), is_brief=True)
            )
            self._receiver.setblocking(False)  # noqa: FBT003 - socket's signature
            self._sender = opened.enter_context(sending_socket(url))
            send_to_group(self._sender, request, (url.host, url.port))
            opened.pop_all()
        self._sent = time.monotonic()

    def __exit__(self, *_: object) -> None:
        """Leave the bus."""
        self.close()

    def close(self) -> None:
        """Leave the bus."""
        self._receiver.close()
        self._sender.close()

    def graph(
        self, missing: Callable[[Container[str]], Iterable[object]] = lambda _: ()
    ) -> "Graph":
        """Return the graph from the answers so far; it is complete if nodes answer in time.

        ``missing`` returns the nodes known to run, except those with the given ids, which have
        answered; they are awaited for up to AT_MOST.
        """
        from lcmtools.graph.builder import GraphBuilder

        builder, answered = GraphBuilder(), set[str]()
        soonest, latest = self._sent + AT_LEAST, self._sent + AT_MOST
        while (now := time.monotonic()) < latest and (now < soonest or any(missing(answered))):
            if found := self._read(builder, min(_QUIET, latest - now)):
                answered |= found
                soonest = max(soonest, time.monotonic() + _QUIET)
        self._read(builder, 0.0)  # if this process was delayed, more has come
        return builder.snapshot(time.time_ns())

    def replies(self, channel: str, seconds: float) -> Iterator[bytes]:
        """Yield the payloads that come on a channel within ``seconds`` of the request."""
        from lcmtools.wire.datagram import ShortMessage, parse

        deadline = self._sent + seconds
        # if this process was delayed, payloads that came meanwhile still count
        while select.select([self._receiver], [], [], max(0.0, deadline - time.monotonic()))[0]:
            message = parse(self._receiver.recv(_MAX_DATAGRAM))
            if isinstance(message, ShortMessage) and message.channel == channel:
                yield message.payload

    def _read(self, builder: "GraphBuilder", timeout: float) -> set[str]:
        """Read all waiting datagrams, or their heads; return the ids of announced nodes."""
        if not select.select([self._receiver], [], [], timeout)[0]:
            return set()
        from lcmtools.wire.packet import Sender
        from lcmtools.wire.reader import Reader

        reader, until = Reader(whole=False, always_whole=()), time.monotonic() + _QUIET
        answered: set[str] = set()
        with contextlib.suppress(BlockingIOError):
            while time.monotonic() < until:
                data, address = self._receiver.recvfrom(_MAX_DATAGRAM)
                packet = reader.read(data, Sender(*address), time.time_ns())
                if announcement := packet and builder.add(packet):
                    answered.add(announcement.node.id)
        return answered
