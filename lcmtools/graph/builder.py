"""Building the graph from packets, and from records of nodes that no longer answer."""

import sys
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from itertools import chain, islice

from lcmtools.bounded import BoundedDict
from lcmtools.graph.model import STALE_AFTER, Endpoint, Graph, NodeInfo, Role, Staleness, Traffic
from lcmtools.graph.protocol import (
    NODE_CHANNEL,
    PROTOCOL_CHANNELS,
    Announcement,
    Head,
    decode_announcement,
)
from lcmtools.wire.packet import Packet, Sender

MOST_FINGERPRINTS = 4
"""A sender with this many fingerprints on a channel does not send LCM types; no more are kept."""
MOST_FLOWS, MOST_NODES = 4000, 2000
"""Channels of a live bus, counted for each sender, and nodes: no more are known."""
_MOST_NODE_BYTES = 2 << 20  # of the announcements of the known nodes, which take five times that
_MOST_SILENT, _SILENT_AFTER = 500, 60_000_000_000
"""While more than this number are known, those silent for this time [ns] are forgotten."""
_OF_TOPICS = frozenset({Role.PUBLISHER, Role.SUBSCRIBER})


class _Count:  # traffic while it is being counted
    __slots__ = ("bytes", "fingerprints", "first_time", "head", "last_time", "messages", "types")

    def __init__(self, first_time: int) -> None:
        self.first_time = first_time
        self.last_time = self.messages = self.bytes = 0
        self.head = b""  # first bytes of the last payload, as many as in a fingerprint
        self.fingerprints: tuple[int, ...] = ()
        self.types: tuple[str, ...] = ()

    def add(self, packet: Packet) -> None:
        _, payload, self.last_time, _, _, whole_bytes, _, type_name = packet
        self.messages += 1
        self.bytes += len(payload) if whole_bytes is None else whole_bytes
        if type_name and type_name not in self.types and len(self.types) < MOST_FINGERPRINTS:
            self.types = (*self.types, type_name)
        head = payload[:8]
        if head != self.head and len(self.fingerprints) < MOST_FINGERPRINTS:
            self.head = head
            fingerprint = packet.fingerprint
            if fingerprint is not None and fingerprint not in self.fingerprints:
                self.fingerprints = (*self.fingerprints, fingerprint)


class GraphBuilder:
    """Learns the graph from the packets of a bus; the node with the id ``but`` is left out.

    For a log, nodes that have left are kept too, because they sent its messages. A live bus may
    grow without end: then those are forgotten that were silent for the longest time.
    """

    def __init__(self, but: str = "", *, is_log: bool = False) -> None:
        self._is_log, self._but = is_log, but
        most_nodes, most_flows = (sys.maxsize,) * 2 if is_log else (MOST_NODES, MOST_FLOWS)
        most_bytes = sys.maxsize if is_log else _MOST_NODE_BYTES
        self._nodes = BoundedDict[str, NodeInfo](most_nodes, most_bytes)
        self._recorded: dict[str, NodeInfo] = {}
        self._left = BoundedDict[str, str](most_nodes, most_bytes)  # names by ids
        self._heads = BoundedDict[bytes, tuple[bytes, str]](most_nodes, most_bytes)
        self._traffic = BoundedDict[tuple[str, Sender | None], _Count](most_flows)
        self._types: dict[str, tuple[str, ...]] | None = None  # by channel; None if out of date

    def add(self, packet: Packet) -> Announcement | None:
        """Learn from one packet; return the announcement if it was one."""
        if packet.channel not in PROTOCOL_CHANNELS:
            self._count_of(packet).add(packet)
            if packet.type_name:
                self._types = None
        elif packet.channel == NODE_CHANNEL:
            self._types = None
            announcement = decode_announcement(packet.payload)
            if announcement is not None:
                self._announced(announcement, packet)
            return announcement
        return None

    def add_all(self, packets: Iterable[Packet]) -> list[Packet]:
        """Learn from packets; return those of the nodes' own protocol."""
        of_protocol: list[Packet] = []
        channel, sender, count = None, None, None
        for packet in packets:
            if not (count and packet[0] is channel and packet[3] is sender):  # rare in a stream
                if packet.channel in PROTOCOL_CHANNELS:
                    self.add(packet)
                    of_protocol.append(packet)
                    continue
                channel, sender = packet[0], packet[3]
                count = self._count_of(packet)
            count.add(packet)
            if packet[7]:  # its type is attached
                self._types = None
        return of_protocol

    def add_head(self, head: Head, packet: Packet) -> None:
        """Learn from an announcement, decoding it only if more than its counters have changed.

        Decoding is most of the work of following a large bus; the counters of a known node stay as
        they were when it was decoded.
        """
        revision, identifier = self._heads.use(head.identity) or (b"", "")
        node = self._nodes.use(identifier)
        if node is not None and revision == head.revision:
            self._nodes[identifier] = node._replace(last_announced=packet.time)
            return
        announcement = self.add(packet)
        if announcement is not None and not announcement.leaving:
            known = head.revision, announcement.node.id
            self._heads.put(head.identity, known, len(head.identity))

    def heard(self) -> set[str]:
        """Return the ids of all nodes that have announced themselves, or left."""
        return {self._but, *self._nodes, *self._left}

    @property
    def forgotten(self) -> int:
        """The number of channels and nodes that were forgotten because there are too many."""
        return self._traffic.forgotten + self._nodes.forgotten

    def recall(self, nodes: Iterable[NodeInfo]) -> None:
        """Learn of nodes from their records; nodes that never announce themselves are stale."""
        for node in nodes:
            self._recorded[node.id] = node

    def forget(self, identifier: str) -> None:
        """Drop a node by its id."""
        self._types = None
        self._nodes.pop(identifier, None)
        self._recorded.pop(identifier, None)

    def senders(self) -> set[Sender]:
        """Return every sender of a packet so far."""
        known = {sender for node in self._nodes.values() for sender in node.senders()}
        return known | {sender for _, sender in self._traffic if sender is not None}

    def types_of(self, channel: str) -> tuple[str, ...]:
        """Return the types that nodes announce for a channel, publishers' first, each once.

        They are followed by the types attached to its messages.
        """
        if self._types is None:
            self._types = self._types_by_channel()
        return self._types.get(channel, ())

    def snapshot(self, now: int) -> Graph:
        """Return the graph at the time ``now`` [ns since 1970]."""
        self._forget_silent(now)
        announced = [x if x.is_recorded else _aged(x, now) for x in self._nodes.values()]
        heard = self.heard()
        unheard = (node for id_, node in self._recorded.items() if id_ not in heard)
        silent = [node._replace(stale=node.stale or Staleness.UNANSWERED) for node in unheard]
        traffic = tuple(self._traffic_seen())
        if not self._is_log:
            traffic += tuple(islice(_observed(announced), MOST_FLOWS))
        sent: dict[Sender | None, list[Traffic]] = defaultdict(list)
        for seen in traffic:
            sent[seen.sender].append(seen)
        known = [x if x.has_details else _with_observed_topics(x, sent) for x in announced]
        nodes = sorted(known + silent, key=lambda node: (node.name, node.start_time))
        return Graph(tuple(nodes), traffic, now)

    def _count_of(self, packet: Packet) -> _Count:
        key = packet.channel, packet.sender
        count = self._traffic.use(key)
        if count is None:
            count = self._traffic[key] = _Count(packet.time)
        return count

    def _types_by_channel(self) -> dict[str, tuple[str, ...]]:
        every = (end for node in self._nodes.values() for end in node.endpoints)
        ends = [end for end in every if end.type and end.role in _OF_TOPICS]
        found: dict[str, dict[str, None]] = {}
        for end in sorted(ends, key=lambda end: end.role):
            found.setdefault(end.topic, {})[end.type] = None
        for (channel, _), count in self._traffic.items():
            for name in count.types:
                found.setdefault(channel, {})[name] = None
        return {channel: tuple(types) for channel, types in found.items()}

    def _forget_silent(self, now: int) -> None:
        """Forget what was silent for long, if much is known: a flood has ended."""
        if self._is_log:
            return
        since = now - _SILENT_AFTER
        traffic, nodes = self._traffic, self._nodes
        while len(traffic) > _MOST_SILENT and traffic.oldest().last_time < since:
            traffic.drop_oldest()
        while len(nodes) > _MOST_SILENT and nodes.oldest().last_announced < since:
            nodes.drop_oldest()
            self._types = None

    def _announced(self, announcement: Announcement, packet: Packet) -> None:
        node = announcement.node
        if self._is_log:
            node = node._replace(is_recorded=True)
        elif announcement.leaving:
            self.forget(node.id)
            self._left.put(node.id, node.name, len(node.id))
            self._forget_behind(node.id)
        if node.id == self._but or node.id in self._left:
            return  # an announcement overtaken by its goodbye must not revive the node
        kept = sum(step.kept for step in node.path)  # by relays, on the way
        lag = packet.time - node.sent - kept if node.sent else None
        known = self._nodes.get(node.id)
        if node.path and known is not None and not (known.path or _aged(known, packet.time).stale):
            return  # the node itself is on this bus
        lags = [one for one in (lag, known and known.lag) if one is not None]
        lag = min(lags, default=None)  # the fastest one shows the clocks' difference best
        sender = None if node.path else packet.sender  # a relay's packets have the relay as sender
        node = node._replace(sender=sender, last_announced=packet.time, lag=lag)
        self._nodes.put(node.id, node, len(packet.payload))

    def _forget_behind(self, relay: str) -> None:
        """Drop the nodes behind a relay that has left; another relay may show them again."""
        behind = [n.id for n in self._nodes.values() if relay in (step.id for step in n.path)]
        for identifier in behind:
            self.forget(identifier)

    def _traffic_seen(self) -> Iterator[Traffic]:
        counts = sorted(self._traffic.items(), key=lambda item: (item[0][0], str(item[0][1])))
        for (channel, sender), one in counts:
            numbers = one.messages, one.bytes, one.first_time, one.last_time
            yield Traffic(channel, sender, one.fingerprints, *numbers, one.types)


def _with_observed_topics(
    node: NodeInfo, sent: Mapping[Sender | None, Iterable[Traffic]]
) -> NodeInfo:
    """Return a node whose endpoints are unknown, with those that its messages show."""
    ends = []
    for seen in chain.from_iterable(sent.get(one, ()) for one in node.senders()):
        end = Endpoint(seen.channel, Role.PUBLISHER, fingerprints=seen.fingerprints)
        last = seen.last_time
        ends.append(end._replace(messages=seen.messages, bytes=seen.bytes, last_time=last))
    return node._replace(endpoints=tuple(ends))


def _observed(nodes: Iterable[NodeInfo]) -> Iterator[Traffic]:
    """Yield what living relays and servers have observed, by the clock of this computer."""
    for node in nodes:
        lag = node.lag or 0
        for seen in () if node.stale else node.observed:
            yield seen._replace(first_time=seen.first_time + lag, last_time=seen.last_time + lag)


def _aged(node: NodeInfo, now: int) -> NodeInfo:
    is_silent = now - node.last_announced > STALE_AFTER
    return node._replace(stale=Staleness.SILENT) if is_silent else node
