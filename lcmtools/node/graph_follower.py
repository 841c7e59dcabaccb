"""Following the announcements of all nodes, starting with the first request for the graph.

On a multicast bus announcements wait in a ``ChannelSocket``, which is emptied a few times a second
and at each request: waking up for each one would cost several times as much. On other buses they
arrive as messages do.
"""

import contextlib
import math
import threading
import time
from collections.abc import Callable

from lcmtools.bounded import BoundedDict
from lcmtools.bus.base import Bus, refusal
from lcmtools.bus.group_receiver import ChannelSocket
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.graph.builder import MOST_NODES, GraphBuilder
from lcmtools.graph.model import Graph
from lcmtools.graph.protocol import NODE_CHANNEL, PROBE_CHANNEL, Head, Probe, encode_probe, head_of
from lcmtools.wire.packet import Packet

_MOST_ANNOUNCED, _MOST_ANNOUNCED_BYTES = MOST_NODES, 8 << 20
"""Nodes, and bytes of their announcements, that are kept until the next request for the graph."""
_READ_PERIOD = 0.2
"""[s] between two reads of the socket. On stock systems its buffer holds about 180 announcements;
200 nodes send 40 in this time."""


class GraphFollower:
    """The announced nodes of a bus; the first request for them subscribes to announcements."""

    def __init__(self, bus: Bus, url: BusUrl | None) -> None:
        self._bus = bus
        self._url = url
        self._lock = threading.Lock()  # guards the builder
        self._builder: GraphBuilder | None = None
        self._announced_lock = threading.Lock()  # held for a moment only, while receiving
        self._announced = self._none_announced()
        self._socket_lock = threading.Lock()
        self._socket: ChannelSocket | None = None
        self._is_closed = self._is_of_parent = False
        self.pause = math.inf
        """The longest time between two calls of ``read`` [s], from ``on_start`` on."""
        self.on_start: Callable[[], None] = lambda: None

    def graph(self) -> Graph:
        """Return the announced nodes; the first call sends a probe.

        A node's counters date from its last change in anything but the counters.

        Raises:
            BusOfParent: This is a forked process, and the node is its parent's.
        """
        if self._is_of_parent:  # its lock may never be free
            raise refusal(is_of_parent=True)
        with self._lock:
            if self._builder is None:
                self._start()
                self._builder = GraphBuilder()
            self.read()
            with self._announced_lock:
                announced, self._announced = self._announced, self._none_announced()
            for head, payload, arrival in announced.values():
                self._builder.add_head(head, Packet(NODE_CHANNEL, payload, arrival))
            return self._builder.snapshot(time.time_ns())

    def close(self) -> None:
        """Stop following."""
        self._is_closed = True
        with self._socket_lock:
            if self._socket is not None:
                self._socket.close()

    def leave_to_parent(self) -> None:
        """Refuse all use in a forked process."""
        self._is_of_parent = True

    def _start(self) -> None:
        self._socket = self._open_socket()
        if self._socket is None:
            self._bus.subscribe(NODE_CHANNEL, self._keep)
        else:
            self.pause = _READ_PERIOD
            self.on_start()
        with contextlib.suppress(BusError):  # nodes announce within 1 s anyway
            self._bus.publish(PROBE_CHANNEL, encode_probe(Probe()))

    def _open_socket(self) -> ChannelSocket | None:
        if self._url is not None and self._url.is_multicast and not self._is_closed:
            with contextlib.suppress(BusError):
                return ChannelSocket(self._url, NODE_CHANNEL)
        return None

    def read(self) -> None:
        """Take the announcements that wait in the socket."""
        with self._socket_lock:
            if self._socket is None:
                return
            for payload, arrival in self._socket.receive():
                self._keep(payload, arrival)
            if self._socket.has_large:  # a node with hundreds of endpoints
                large, self._socket, self.pause = self._socket, None, math.inf
                with contextlib.suppress(BusError):  # it is closing
                    self._bus.subscribe(NODE_CHANNEL, self._keep)
                large.close()

    def _keep(self, payload: bytes, arrival: int) -> None:
        """Keep each node's latest announcement; decoding all would be most of the work."""
        head = head_of(payload)
        with self._announced_lock:
            size = len(payload) + len(head.identity)
            self._announced.put(head.identity, (head, payload, arrival), size)

    @staticmethod
    def _none_announced() -> BoundedDict[bytes, tuple[Head, bytes, int]]:
        return BoundedDict(_MOST_ANNOUNCED, _MOST_ANNOUNCED_BYTES)
