"""Following the graph: what a process's nodes know of all nodes, from the first question on.

Where the bus has mailboxes, announcements wait in one, and are taken out a few times a second and
whenever somebody asks: to be woken for each one would cost a follower several times as much.
Elsewhere they come as messages do.
"""

import contextlib
import threading
import time
from collections.abc import Iterable

from lcmtools.bus.base import Bus
from lcmtools.bus.channel_socket import ChannelSocket
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.graph.builder import GraphBuilder
from lcmtools.graph.model import Graph
from lcmtools.graph.protocol import (
    NODE_CHANNEL,
    PROBE_CHANNEL,
    Head,
    Probe,
    encode_probe,
    head_of,
)
from lcmtools.wire.packet import Packet

_MOST_ANNOUNCED = 10_000
"""Announcements that are kept until somebody asks for the graph."""
_LOOK_PERIOD = 0.2
"""[s] between two looks into the mailbox. A socket's buffer as stock systems grant it holds about
180 announcements, and 200 nodes make 40 in this time."""


class Following:
    """The announced nodes of a bus; the first question starts listening to them.

    Args:
        bus: The connection.
        url: Where it leads; None for a private bus.
    """

    def __init__(self, bus: Bus, url: BusUrl | None) -> None:
        self._bus = bus
        self._url = url
        self._lock = threading.Lock()  # of the builder
        self._builder: GraphBuilder | None = None
        self._announced_lock = threading.Lock()  # held for a moment only, on the receiving thread
        self._announced: dict[bytes, tuple[Head, bytes, int]] = {}
        self._channel_socket: ChannelSocket | None = None
        self._mailbox_lock = threading.Lock()
        self._closed = threading.Event()
        self._thread: threading.Thread | None = None

    def graph(self) -> Graph:
        """The announced nodes of the bus; the first call asks them to announce themselves.

        A node's counters are those of when it last changed otherwise.
        """
        with self._lock:
            if self._builder is None:
                self._start()
                self._builder = GraphBuilder()
            self._empty_mailbox()
            for head, payload, arrival in self._take_announced():
                self._builder.hear_head(head, Packet(NODE_CHANNEL, payload, arrival))
            return self._builder.snapshot(time.time_ns())

    def close(self) -> None:
        """Follow no more."""
        self._closed.set()
        if self._thread is not None:
            self._thread.join(timeout=1.0)
        with self._mailbox_lock:
            if self._channel_socket is not None:
                self._channel_socket.close()

    def _start(self) -> None:
        self._channel_socket = self._open_mailbox()
        if self._channel_socket is None:
            self._bus.subscribe(NODE_CHANNEL, self._hear)
        else:
            self._thread = threading.Thread(target=self._run, name="follower", daemon=True)
            self._thread.start()
        with contextlib.suppress(BusError):  # without it, they announce within a second
            self._bus.publish(PROBE_CHANNEL, encode_probe(Probe()))

    def _open_mailbox(self) -> ChannelSocket | None:
        if self._url is None or not self._url.is_multicast or self._closed.is_set():
            return None
        with contextlib.suppress(BusError):
            return ChannelSocket(self._url, NODE_CHANNEL)
        return None

    def _run(self) -> None:
        while self._channel_socket is not None and not self._closed.wait(_LOOK_PERIOD):
            self._empty_mailbox()

    def _empty_mailbox(self) -> None:
        with self._mailbox_lock:
            if self._channel_socket is None:
                return
            for payload, arrival in self._channel_socket.take():
                self._hear(payload, arrival)
            if self._channel_socket.has_large:  # a node with hundreds of endpoints
                channel_socket, self._channel_socket = self._channel_socket, None
                with contextlib.suppress(BusError):  # it closes
                    self._bus.subscribe(NODE_CHANNEL, self._hear)
                channel_socket.close()

    def _hear(self, payload: bytes, arrival: int) -> None:
        """Keep each node's latest announcement; decoding all would be most of the work."""
        head = head_of(payload)
        with self._announced_lock:
            if len(self._announced) < _MOST_ANNOUNCED or head.identity in self._announced:
                self._announced[head.identity] = head, payload, arrival

    def _take_announced(self) -> Iterable[tuple[Head, bytes, int]]:
        with self._announced_lock:
            announced, self._announced = self._announced, {}
        return announced.values()
