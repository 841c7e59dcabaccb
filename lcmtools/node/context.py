"""What all nodes of a process share: the bus, the announcer, the arguments, the way to end.

Which of a process's contexts is the one that ``init`` made is process.py's business, and so are
signals.
"""

import contextlib
import socket
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from typing import Protocol

from lcmtools.arguments import NodeArguments
from lcmtools.bus.base import Bus
from lcmtools.bus.listeners import PlainListeners
from lcmtools.bus.records import NodeRecords
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.graph.builder import GraphBuilder
from lcmtools.graph.model import Graph, Node, Role
from lcmtools.graph.protocol import (
    NODE_CHANNEL,
    PROBE_CHANNEL,
    SHUTDOWN_CHANNEL,
    Head,
    Probe,
    decode_shutdown,
    encode_probe,
    head_of,
)
from lcmtools.names import resolve_namespace
from lcmtools.node.announcer import Announcer
from lcmtools.node.logger import Logger
from lcmtools.node.wakeup import Wakeup
from lcmtools.settings import usual_namespace
from lcmtools.wire.packet import Packet

_MOST_ANNOUNCED = 10_000
"""Announcements that are kept until somebody asks for the graph."""


class Participant(Protocol):
    """What the context needs of a node; see lcmtools.node.node."""

    def describe(self) -> Node:
        """What is announced."""
        ...

    def get_logger(self) -> Logger:
        """Its log."""
        ...

    def destroy_node(self) -> None:
        """Leave the bus."""
        ...


class Context:
    """A process's connection to a bus, with the nodes on it.

    Args:
        bus: The connection; closed with the context.
        arguments: What the command line said.
        environment: The process's environment variables.
        records: Where nodes leave their records; None for none.
        url: The bus; None for one that nobody else is on.
    """

    def __init__(
        self,
        bus: Bus,
        arguments: NodeArguments,
        environment: Mapping[str, str],
        records: NodeRecords | None = None,
        url: BusUrl | None = None,
    ) -> None:
        self.default_namespace = resolve_namespace(usual_namespace(environment))
        self.bus = bus
        self.arguments = arguments
        self.wakeup = Wakeup()
        self.declared_parameters: set[str] = set()
        self.notices: list[str] = []
        """What the first node should log: something on the command line has no effect."""
        self.on_asked_to_end: Callable[[], None] = self.stop
        """What another program's request to end does."""
        self.host = socket.gethostname()
        self._records = records
        self._plain_listeners = PlainListeners(url, self._pids_here) if url else None
        self._participants: list[Participant] = []
        self._stopping = False
        self._closed = False
        self._is_asked = False
        self.is_told = False
        """Whether the program has been told to end: what it does from then on is its ending."""
        self._graph_lock = threading.Lock()
        self._graph_builder: GraphBuilder | None = None
        self._announced_lock = threading.Lock()  # held for a moment only, on the receiving thread
        self._announced: dict[bytes, tuple[Head, bytes, int]] = {}
        self.announcer = Announcer(bus, self._describe)
        bus.subscribe(SHUTDOWN_CHANNEL, self._asked_to_end)

    def ok(self) -> bool:
        """Whether nodes should go on."""
        return not self._stopping

    def is_closed(self) -> bool:
        """Whether the bus has been left."""
        return self._closed

    def stop(self) -> None:
        """Ask everything that spins to return. Safe in signal handlers."""
        self._stopping = True
        self.wakeup.set()

    def add(self, participant: Participant) -> None:
        """Take a node in: announce it, and record that it runs."""
        self._participants.append(participant)
        if self._records:
            self._records.write(participant.describe())
        self.announcer.announce_soon()

    def remove(self, participant: Participant) -> None:
        """Let a node go: say goodbye for it."""
        if participant in self._participants:
            self._participants.remove(participant)
            node = participant.describe()
            self.announcer.say_goodbye(node)
            if self._records:
                self._records.remove(node.id)

    def is_first(self) -> bool:
        """Whether no node has been made yet: ``__name:=`` names the first one."""
        return not self._participants

    def graph(self) -> Graph:
        """The announced nodes of the bus; the first call starts listening to them.

        A node's counters are those of when it last changed otherwise.
        """
        if self._graph_builder is None:
            self._graph_builder = GraphBuilder()
            self.bus.subscribe(NODE_CHANNEL, self._hear)
            with contextlib.suppress(BusError):  # without it, they announce within a second
                self.bus.publish(PROBE_CHANNEL, encode_probe(Probe()))
        with self._graph_lock:
            for head, payload, now in self._take_announced():
                self._graph_builder.hear_head(head, Packet(NODE_CHANNEL, payload, now))
            return self._graph_builder.snapshot(time.time_ns())

    def heard_topics(self) -> frozenset[str]:
        """The topics that nodes announce to listen to."""
        return frozenset(
            endpoint.topic
            for node in self.graph().nodes
            if not node.stale
            for endpoint in node.having(Role.SUBSCRIBER)
        )

    def has_plain_listeners(self) -> bool:
        """Whether there can be programs that listen and never announce it: to any topic."""
        return bool(self._plain_listeners and self._plain_listeners.possible())

    def _pids_here(self) -> frozenset[int]:
        """The processes of this computer that are nodes."""
        return frozenset(node.pid for node in self.graph().nodes if node.host == self.host)

    def close(self) -> None:
        """End all nodes and leave the bus."""
        if self._closed:
            return
        self._closed = True
        self.stop()
        for participant in tuple(self._participants):
            participant.destroy_node()
        self.announcer.close()
        self.bus.close()
        self.wakeup.close()

    def _describe(self) -> list[Node]:
        return [participant.describe() for participant in tuple(self._participants)]

    def _hear(self, payload: bytes, now: int) -> None:
        """Keep each node's latest announcement; decoding all would be most of the work."""
        head = head_of(payload)
        with self._announced_lock:
            if len(self._announced) < _MOST_ANNOUNCED or head.identity in self._announced:
                self._announced[head.identity] = head, payload, now

    def _asked_to_end(self, payload: bytes, _time: int) -> None:
        """End this program if one of its nodes is meant; on the receiving thread.

        Answered before it ends, so that whoever asks can tell a program that hangs.
        """
        request = decode_shutdown(payload)
        if request is None:
            return
        for participant in tuple(self._participants):
            node = participant.describe()
            if node.id == request.target:
                self.announcer.answer(node.name, request.nonce)
                if not self._is_asked:  # who hears no answer asks again
                    self._is_asked = True
                    who = f"by {request.requester}" if request.requester else "over the bus"
                    participant.get_logger().warning(f"asked to end {who}")
                    self.on_asked_to_end()
                return

    def _take_announced(self) -> Iterable[tuple[Head, bytes, int]]:
        with self._announced_lock:
            announced, self._announced = self._announced, {}
        return announced.values()
