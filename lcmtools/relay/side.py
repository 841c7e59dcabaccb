"""One bus of a relay: its graph, the messages that wait for it, and those that come from it."""

import math
import socket
import threading
import time
from collections.abc import Collection, Mapping
from dataclasses import replace

from lcmtools.bounded import BoundedDict
from lcmtools.bus.udp_sender import PACED_ABOVE_BYTES
from lcmtools.errors import LcmtoolsError
from lcmtools.graph.builder import MOST_NODES, GraphBuilder
from lcmtools.graph.full_line import LineRates
from lcmtools.graph.model import STALE_AFTER, FullLine, Graph, Traffic
from lcmtools.graph.protocol import PROTOCOL_CHANNELS, Announcement, head_of
from lcmtools.graph.relay_report import End
from lcmtools.messages.registry import candidates
from lcmtools.observe.simulators import is_simulator
from lcmtools.relay.announcing import heard_of_programs, is_young, renamed
from lcmtools.relay.ends import BusEnd
from lcmtools.relay.fair_queue import LATE, LineMessage, LineQueue
from lcmtools.relay.rules import INTERNAL, Direction, Reason, Route
from lcmtools.wire.packet import Packet, Sender
from lcmtools.wire.stamp import Origin

_MOST_COMMANDS = 20
_MOST_BYTES = 64 << 20  # of the latest messages that are kept
_WAIT = 0.1  # [s]
_SMALL = 16 << 10  # largest message [byte] kept for a topic that is not known to be latched

_Latest = BoundedDict[tuple[str, Sender | None], LineMessage]


class Side:
    """One bus of a relay, with the rules for messages from it."""

    def __init__(self, identifier: str, bus: str, end: BusEnd, direction: Direction) -> None:
        self.identifier, self.bus, self.end = identifier, bus, end
        self.direction = direction
        self.queue = LineQueue()  # messages that wait to be sent to the bus
        # Topics that do not pass because they are not named exactly, with their names there.
        self.commands: dict[str, str] = {}
        self.named_only: dict[str, None] = {}  # the names in the options of topics that need them
        self.has_new_route = False  # since the last ``observed``
        self._rates = LineRates()
        self._builder = GraphBuilder()
        self._graph: Graph | None = None
        # Nodes on this bus with the times of their last announcements.
        self._own_nodes = BoundedDict[str, int](MOST_NODES, _MOST_BYTES)
        self._revisions = BoundedDict[bytes, bytes](MOST_NODES, _MOST_BYTES)
        self._lock = threading.Lock()  # guards the graph
        self._routes = BoundedDict[tuple[str, bytes], Route]()
        self._next = BoundedDict[str, float]()
        # The last messages of each sender on latched topics, and on those not known to be latched.
        self._latched, self._last = (_Latest(most_bytes=_MOST_BYTES) for _ in range(2))
        self._messages = self._bytes = self._left_out = self._failed = 0
        self.late = 0  # messages from this bus that were held up before they came here

    def sort(
        self, packets: list[Packet], other: "Side", *, passes: bool
    ) -> tuple[list[Packet], list[LineMessage]]:
        """Return the messages of the protocol among these, and the messages for the other bus."""
        of_protocol, passed = [], []
        takes_origin = other.end.takes_origin
        routes, left_out, late = self._routes, 0, 0
        due, oldest = time.monotonic() + LATE, time.time_ns() - LATE * 1e9
        for packet in packets:
            channel, payload = packet.channel, packet.payload
            if channel in PROTOCOL_CHANNELS:
                of_protocol.append(packet)
                continue
            route = routes.get((channel, payload[:8])) or self._route(packet, other)
            if route.reason or (route.period and self._is_too_soon(packet, route.period)):
                left_out += passes
            elif packet.time < oldest and not route.latched:  # held up before it came here
                late += passes
            else:
                origin = origin_of(packet) if takes_origin else None
                until = math.inf if route.latched else due
                message = LineMessage(route.name, payload, route.newest, origin, until)
                passed.append(message)
                if route.latched or len(payload) <= _SMALL:
                    # also while standing by, for a takeover
                    self._keep(packet, message, is_latched=route.latched)
        self._left_out += left_out
        self.late += late
        with self._lock:
            self._builder.add_all([x for x in packets if x.channel not in PROTOCOL_CHANNELS])
        return of_protocol, passed if passes else []

    def _keep(self, packet: Packet, message: LineMessage, *, is_latched: bool) -> None:
        key = packet.channel, packet.sender
        if is_latched:
            self._last.pop(key, None)
        (self._latched if is_latched else self._last).put(key, message, len(packet.payload))

    def add_announcement(self, packet: Packet) -> Announcement | None:
        """Add an announcement to the graph; return it."""
        with self._lock:
            announcement = self._builder.add(packet)
        if announcement is not None and not announcement.node.path:
            identifier = announcement.node.id
            time_ = 0 if announcement.leaving else packet.time
            self._own_nodes.put(identifier, time_, len(identifier))
        return announcement

    def is_news(self, packet: Packet) -> bool:
        """Return whether an announcement has more news than new counts."""
        head = head_of(packet.payload)
        is_same = self._revisions.use(head.identity) == head.revision
        self._revisions.put(head.identity, head.revision, len(head.identity) + len(head.revision))
        return not is_same

    def has(self, identifier: str) -> bool:
        """Return whether a node is on this bus itself and is alive."""
        return time.time_ns() - self._own_nodes.get(identifier, 0) <= STALE_AFTER

    def graph(self) -> Graph:
        """Return the nodes on this bus."""
        with self._lock:
            if self._graph is None:
                self._graph = self._builder.snapshot(time.time_ns())
            return self._graph

    def observed(self) -> tuple[Traffic, ...]:
        """Return the recent messages of programs that are not nodes, as the other bus is told."""
        with self._lock:
            graph = self._builder.snapshot(time.time_ns())
        self.has_new_route = any(is_young(seen, graph.time) for seen in graph.foreign())
        return renamed(heard_of_programs(graph, self.bus), self.direction)

    def full_line(self, now: float) -> tuple[FullLine, ...]:
        """Return the line to this bus, if it takes less than it gets; ``now`` is monotonic [s]."""
        queue, of_end = self.queue.waiting, dict(self.end.dropped_of)  # may grow meanwhile
        dropped = dict(queue.dropped_of)
        for channel, number in of_end.items():
            dropped[channel] = dropped.get(channel, 0) + number
        taken = dict(queue.passed_of).items()
        passed = {name: number - of_end.get(name, 0) for name, number in taken}
        rates = self._rates.update(passed, dropped, now)
        if not rates:
            return ()
        named = ((self.direction.typed_name(name), rate) for name, rate in rates.items())
        return (FullLine(self.bus, queue.dropped + self.end.dropped, tuple(named)),)

    def forget_routes(self) -> None:
        """Recompute which topics pass, because nodes have come or gone."""
        self._routes = BoundedDict[tuple[str, bytes], Route]()
        with self._lock:
            self._graph = None

    def obeyed(self, topic: str) -> bool:
        """Return whether a simulator on this bus obeys messages on a topic."""
        subscribers = self.graph().topic(topic).subscribers
        return any(is_simulator(node) for node, _ in subscribers if not node.stale)

    def send(self, messages: list[LineMessage]) -> None:
        """Send messages, at once if that does not block; otherwise queue them.

        An additional thread between receiving and sending would make each wait for the other.
        """
        at_once = 0
        if self.end.is_quick and self.queue.is_idle:
            for message in messages:
                if len(message.payload) > PACED_ABOVE_BYTES:
                    break
                self._send(message)
                at_once += 1
        if at_once < len(messages):
            self.queue.add(messages[at_once:])

    def latched(self) -> list[LineMessage]:
        """Return the last received messages of each topic that is still latched."""
        topic = self.graph().topic
        kept = [*self._last.items(), *self._latched.items()]
        return [one._replace(due=math.inf) for (name, _), one in kept if topic(name).is_latched]

    def send_waiting(self) -> None:
        """Send the waiting messages that are not late."""
        for message in self.queue.pop(_WAIT):
            if not self.queue.is_late(message):
                self._send(message)

    def _send(self, message: LineMessage) -> None:
        """Send a message and count it, even if that fails."""
        counts = message.channel not in PROTOCOL_CHANNELS
        try:
            self.end.send(message)
        except LcmtoolsError:
            self._failed += counts
        else:
            self._messages += counts
            self._bytes += len(message.payload) if counts else 0

    def send_first(self, channel: str, payload: bytes) -> None:
        """Queue a message of the protocol."""
        self.queue.add_first(LineMessage(channel, payload))

    def send_now(self, channel: str, payload: bytes) -> None:
        """Send a message of the protocol, once no other thread is sending."""
        try:
            self.end.send(LineMessage(channel, payload))
        except LcmtoolsError:
            self._failed += 1

    def awaited(self, commands: Mapping[str, str]) -> tuple[str, ...]:
        """Return the commands of the other bus to which a node of this one subscribes."""
        topic, names = self.graph().topic, list(commands.items())
        ends = ((command, topic(name).subscribers) for command, name in names)
        return tuple(command for command, subs in ends if any(not node.tool for node, _ in subs))

    def state(self, other: "Side | None" = None) -> End:
        """Return the state of the end, with its counts; its messages go to ``other``."""
        trouble, late = self.end.trouble, other.late if other else 0
        return End(
            self.identifier,
            self.bus,
            ports=self.end.ports,
            is_up=not trouble,
            trouble=trouble,
            messages=self._messages,
            bytes=self._bytes,
            left_out=self._left_out,
            dropped=self._failed + self.queue.waiting.dropped + self.end.dropped + late,
            lost=sum(loss.lost for loss in self.end.losses().values()),
            commands=other.awaited(self.commands) if other and self.commands else (),
        )

    def _route(self, packet: Packet, other: "Side") -> Route:
        name = self.direction.name(packet.channel)
        obeyed = not isinstance(name, Reason) and other.obeyed(name)
        route = self.direction.route(packet.channel, self._types(packet), obeyed=obeyed)
        route = replace(route, latched=self.graph().topic(packet.channel).is_latched)
        self._routes[packet.channel, packet.payload[:8]] = route
        self.has_new_route = True
        if route.reason is Reason.COMMAND and len(self.commands) < _MOST_COMMANDS:
            self.commands[packet.channel] = str(name)
        if route.reason in (Reason.COMMAND, Reason.NAMED_ONLY):
            typed = self.direction.typed_name(packet.channel)
            if len(self.named_only) < _MOST_COMMANDS and not typed.startswith(INTERNAL):
                self.named_only[typed] = None
        return route

    def _types(self, packet: Packet) -> Collection[str]:
        """Return the possible types of a message: announced, or from its fingerprint."""
        announced = {*self.graph().topic(packet.channel).types, packet.type_name} - {""}
        fingerprint = packet.fingerprint
        return {*announced, *(candidates(fingerprint) if fingerprint is not None else ())}

    def _is_too_soon(self, packet: Packet, period: float) -> bool:
        """Return whether less than the period has passed since the last passed message."""
        now = packet.time / 1e9
        due = self._next.get(packet.channel, 0.0)
        if now < due <= now + period:
            return True
        self._next[packet.channel] = (due if due > now - period else now) + period
        return False


def origin_of(packet: Packet) -> Origin | None:
    """Return the origin of a message that is passed on; None if the bus has no senders."""
    if packet.origin is not None:
        return packet.origin._replace(hops=packet.origin.hops + 1)
    if packet.sender is None or packet.seqno is None:
        return None
    address = int.from_bytes(socket.inet_aton(packet.sender.address), "big")
    return Origin(address << 16 | packet.sender.port, packet.seqno, 1)
