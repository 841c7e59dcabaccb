"""The graph's values: nodes, their endpoints, and the messages observed on the channels."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum, IntEnum

from lcmtools.names import base_name_of, is_hidden
from lcmtools.wire.packet import Sender

STALE_AFTER = 3_000_000_000
"""A node that has not announced itself for so long is stale [ns]."""

_SELF_TEST = "LCM_SELF_TEST"


class Role(IntEnum):
    """A node's role for a topic or service (the constants of lcmtools_msgs/Endpoint)."""

    PUBLISHER = 0
    SUBSCRIBER = 1
    SERVICE = 2
    CLIENT = 3


class Staleness(str, Enum):
    """The reason why a node is stale; empty, and so false, for one that is alive."""

    NOT = ""
    SILENT = "announces itself no more"
    UNANSWERED = "does not answer"
    HANGS = "runs but does not answer"
    ENDED = "ended without saying goodbye"

    def __str__(self) -> str:
        """Return the text."""
        return self.value

    def __format__(self, spec: str) -> str:
        """Return the text; Python versions differ in what they do otherwise."""
        return format(self.value, spec)


@dataclass(frozen=True, slots=True)
class Endpoint:
    """One publisher, subscription, service or client of a node.

    Attributes:
        topic: The full name of the topic or service.
        role: The node's role for it.
        types: The declared type first, then others that are accepted too ("package/Name").
        fingerprints: Of ``types``, unsigned.
        group: Subscriptions of a node with the same group are alternatives of each other.
        depth: Queue depth in messages; 0 where there is no queue.
        messages: Messages sent or received so far.
        bytes: Bytes of their payloads.
        drops: Messages that a full queue pushed out.
        last_time: Time of the last one, nanoseconds since 1970; 0 for none.
        calls: Number of calls of the callback; 0 where there is none.
        busy: Time spent in the callback, in a running call too [ns].
        longest: Time of the longest call, of a running one so far [ns].
    """

    topic: str
    role: Role
    types: tuple[str, ...] = ()
    fingerprints: tuple[int, ...] = ()
    group: str = ""
    depth: int = 0
    messages: int = 0
    bytes: int = 0
    drops: int = 0
    last_time: int = 0
    calls: int = 0
    busy: int = 0
    longest: int = 0

    @property
    def type(self) -> str:
        """The declared type; "" when there is none."""
        return self.types[0] if self.types else ""


@dataclass(frozen=True, slots=True)
class Node:
    """A named participant of the bus.

    Attributes:
        name: Full name ("/husky0/simple_controller").
        id: Unique for each run of each node.
        host: Name of its computer.
        pid: Its process there.
        start_time: Its start, nanoseconds since 1970.
        command: Its command line.
        tool: A command that looks at the bus for a while, not a part of the system.
        ports: UDP ports it sends from, besides the one its announcements come from.
        endpoints: What it publishes, subscribes and serves.
        sender: The source of its announcements; None where the bus names none.
        last_announced: Arrival of its last announcement, nanoseconds since 1970; 0 for none.
        stale: The reason why it counts as stale; false for a node that is alive.
        busy: Time spent in its callbacks, those of timers too [ns].
        sent: Time of its last announcement by its own computer's clock, nanoseconds since 1970; 0
            if unknown.
        lag: Shortest time from the sending of an announcement to its arrival, by the two computers'
            clocks [ns]: negative if its clock is ahead; None if unknown.
    """

    name: str
    id: str
    host: str
    pid: int
    start_time: int = 0
    command: str = ""
    tool: bool = False
    ports: tuple[int, ...] = ()
    endpoints: tuple[Endpoint, ...] = ()
    sender: Sender | None = None
    last_announced: int = 0
    stale: Staleness = Staleness.NOT
    busy: int = 0
    sent: int = 0
    lag: int | None = None

    def having(self, role: Role) -> tuple[Endpoint, ...]:
        """Return the endpoints of one role, sorted by topic."""
        return tuple(
            sorted((e for e in self.endpoints if e.role is role), key=lambda one: one.topic)
        )

    def senders(self) -> frozenset[Sender]:
        """Return all senders that are known to be this node."""
        if self.sender is None:
            return frozenset()
        address = self.sender.address
        return frozenset({self.sender, *(Sender(address, port) for port in self.ports)})

    def time_there(self, now: int) -> int:
        """Return the time of the node's computer, which its counters use, at the time ``now`` here.

        Both [ns since 1970], and equal if the lag is unknown.
        """
        return now - (self.lag or 0)

    @property
    def is_hidden(self) -> bool:
        """True if lists leave it out."""
        return is_hidden(self.name)


@dataclass(frozen=True, slots=True)
class Traffic:
    """One sender's observed messages on one channel.

    Attributes:
        channel: The channel.
        sender: The sender; None where the bus names none.
        fingerprints: Fingerprints in order of appearance; a few where they keep changing, as with
            data that is no LCM message.
        messages: Number of messages.
        bytes: Bytes of their payloads.
        first_time: Arrival of the first, nanoseconds since 1970.
        last_time: Arrival of the last.
    """

    channel: str
    sender: Sender | None
    fingerprints: tuple[int, ...]
    messages: int
    bytes: int
    first_time: int
    last_time: int

    def rate(self) -> float | None:
        """Return the messages per second, first to last; None before two messages."""
        if self.messages < 2 or self.last_time <= self.first_time:  # noqa: PLR2004 - an interval
            return None
        return (self.messages - 1) * 1e9 / (self.last_time - self.first_time)


@dataclass(frozen=True, slots=True)
class Topic:
    """The known facts of one topic.

    Attributes:
        name: The channel's name.
        publishers: Nodes with their endpoints that announce to publish it.
        subscribers: Nodes with their endpoints that announce to subscribe to it.
        traffic: The observed messages, by sender.
        foreign: The part of ``traffic`` that no announced node has sent. Where the bus names no
            sender, an announced publisher explains all of it.
    """

    name: str
    publishers: tuple[tuple[Node, Endpoint], ...]
    subscribers: tuple[tuple[Node, Endpoint], ...]
    traffic: tuple[Traffic, ...]
    foreign: tuple[Traffic, ...]

    @property
    def types(self) -> tuple[str, ...]:
        """The announced types, publishers' first, each once."""
        declared = [endpoint.type for _, endpoint in self.publishers + self.subscribers]
        return tuple(dict.fromkeys(name for name in declared if name))

    @property
    def fingerprints(self) -> tuple[int, ...]:
        """The fingerprints seen on the channel, each once."""
        return tuple(dict.fromkeys(f for seen in self.traffic for f in seen.fingerprints))


@dataclass(frozen=True, slots=True)
class Graph:
    """All that is known of a bus at one time.

    Attributes:
        nodes: Announced nodes, sorted by name; stale ones included.
        traffic: The observed messages, on hidden channels too.
        time: Time of this snapshot, nanoseconds since 1970.
    """

    nodes: tuple[Node, ...] = ()
    traffic: tuple[Traffic, ...] = ()
    time: int = 0

    def topic_names(self) -> list[str]:
        """Return all topics that are published, observed, or subscribed to by a node; sorted."""
        announced = {
            endpoint.topic
            for node in self.nodes
            for endpoint in node.endpoints
            if endpoint.role is Role.PUBLISHER
            or (endpoint.role is Role.SUBSCRIBER and not node.tool)
        }
        return sorted(announced | {seen.channel for seen in self.traffic})

    def topic(self, name: str) -> Topic:
        """Return the facts of one topic; empty when there are none."""
        ends = [(node, end) for node in self.nodes for end in node.endpoints if end.topic == name]
        return _topic(name, ends, [t for t in self.traffic if t.channel == name], self._senders())

    def topics(self) -> list[Topic]:
        """Return every topic, sorted; all of them at once, which is quicker than one by one."""
        ends: dict[str, list[tuple[Node, Endpoint]]] = {}
        for node in self.nodes:
            for endpoint in node.endpoints:
                ends.setdefault(endpoint.topic, []).append((node, endpoint))
        traffic: dict[str, list[Traffic]] = {}
        for seen in self.traffic:
            traffic.setdefault(seen.channel, []).append(seen)
        senders = self._senders()
        return [
            _topic(name, ends.get(name, ()), traffic.get(name, ()), senders)
            for name in self.topic_names()
        ]

    def foreign(self) -> list[Traffic]:
        """Return the messages that no announced node has sent, without LCM's self tests.

        See ``Topic.foreign``.
        """
        return [seen for one in self.topics() if one.name != _SELF_TEST for seen in one.foreign]

    def named(self, name: str) -> list[Node]:
        """Return the nodes that a typed name means: a full name, or the last part of one."""
        full = name if name.startswith("/") else f"/{name}"
        exact = [node for node in self.nodes if node.name == full]
        if exact or name.startswith("/"):
            return exact
        return [node for node in self.nodes if base_name_of(node.name) == name]

    def _senders(self) -> frozenset[Sender]:
        return frozenset(sender for node in self.nodes for sender in node.senders())


def _topic(
    name: str,
    ends: Iterable[tuple[Node, Endpoint]],
    traffic: Iterable[Traffic],
    senders: frozenset[Sender],
) -> Topic:
    publishers = tuple(end for end in ends if end[1].role is Role.PUBLISHER)
    subscribers = tuple(end for end in ends if end[1].role is Role.SUBSCRIBER)
    foreign = (
        seen
        for seen in traffic
        if seen.sender not in senders and not (seen.sender is None and publishers)
    )
    return Topic(name, publishers, subscribers, tuple(traffic), tuple(foreign))
