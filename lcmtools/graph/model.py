"""The graph's values: nodes, their endpoints, and the messages observed on channels."""

from collections import defaultdict
from enum import Enum, IntEnum
from typing import NamedTuple

from lcmtools.forks import cached_property
from lcmtools.names import SELF_TEST_CHANNEL, base_name_of, is_hidden
from lcmtools.wire.packet import Sender

VERSION = 2
"""The version of the protocol of announcements: greater by one with each field appended to it."""
STALE_AFTER = 3_000_000_000
"""A node that has not announced itself for this time is stale [ns]."""


class Role(IntEnum):
    """A node's role for a topic or service (the constants of lcmtools_msgs/Endpoint)."""

    PUBLISHER = 0
    SUBSCRIBER = 1
    SERVICE = 2
    CLIENT = 3


class Staleness(str, Enum):
    """The reason why a node is stale; empty, and so false, for a living one."""

    NOT = ""
    SILENT = "no longer announces itself"
    UNANSWERED = "does not answer"
    HANGS = "runs but does not answer"
    ENDED = "ended without saying goodbye"

    __str__ = str.__str__


class Endpoint(NamedTuple):
    """One publisher, subscription, service or client of a node."""

    topic: str  # the full name of the topic or service
    role: Role  # the node's role for it
    types: tuple[str, ...] = ()  # the declared one first, then others that are also accepted
    fingerprints: tuple[int, ...] = ()  # of ``types``, unsigned
    group: str = ""  # subscriptions of a node with the same group are alternatives to each other
    depth: int = 0  # of the queue, in messages; 0 without a queue
    messages: int = 0  # number sent or received so far
    bytes: int = 0  # of their payloads
    drops: int = 0  # messages that newer ones displaced from a full queue
    last_time: int = 0  # of the last message [ns since 1970]; 0 for none
    calls: int = 0  # calls of the callback; 0 without one
    busy: int = 0  # time spent in the callback, including a running call [ns]
    longest: int = 0  # time of the longest call, or of a running one so far [ns]
    latched: bool = False  # the last message is sent again to each new subscriber
    incomplete: int = 0  # messages of which parts were lost on their way
    rate: float = 0.0  # of its messages in the last one or two seconds [Hz]; 0 if unknown

    @property
    def key(self) -> tuple[object, ...]:
        """Its identity among the endpoints of its node."""
        return self.topic, self.role, self.group, self.types

    @property
    def is_counted(self) -> bool:
        """False for an endpoint whose program counts no messages: a plain one, or a command."""
        return bool(self.depth or self.messages or self.last_time)

    def rate_since(self, earlier: "Endpoint") -> float | None:
        """Return the rate of its messages since an earlier announcement [Hz].

        It is the number of messages counted between them, over the time between their last
        messages. None if no message came, or if the earlier one had none.
        """
        messages, span = self.messages - earlier.messages, self.last_time - earlier.last_time
        if messages <= 0 or span <= 0 or not earlier.last_time:
            return None
        return messages * 1e9 / span

    def is_steady_since(self, earlier: "Endpoint", time: int, most: int) -> bool:
        """Return whether its messages began without a pause at ``time`` [ns], that of the earlier.

        Before a single message, a pause is longer than ``most`` [ns]; before several, it is longer
        than two of the intervals that followed.
        """
        messages = self.messages - earlier.messages
        usual = (self.last_time - time) / (messages - 1) if messages > 1 else most / 2
        return time - earlier.last_time <= 2 * usual

    @property
    def type(self) -> str:
        """The declared type; "" if there is none."""
        return self.types[0] if self.types else ""


class CallbackError(NamedTuple):
    """An exception that a node's callback has raised, once or repeatedly."""

    callback: str  # "/odometry", "timer 0.1 s", "service /reset" or "parameters"
    exception: str  # "AttributeError"
    message: str  # the first line of its text, shortened
    place: str  # innermost line in the user's own code: "simple_controller.py:35"
    count: int  # type: ignore[assignment] # not tuple.count: times raised since the node's start
    last_time: int  # nanoseconds since 1970


class RelayStep(NamedTuple):
    """A relay that a node's announcement has passed."""

    id: str  # the relay's id
    relay: str  # its name as a node
    bus: str  # the bus from which it took the announcement
    kept: int = 0  # for which it kept the announcement before it sent it [ns]


class FullLine(NamedTuple):
    """A connection of a node that does not take all that is sent to it."""

    to: str  # the bus, client or address at its other end
    dropped: int  # messages for it that were dropped since the start
    # The topics that lost messages in the last seconds, as a relay's options name them, with the
    # rates of their messages that passed [Hz].
    passing: tuple[tuple[str, float], ...] = ()


class NodeInfo(NamedTuple):
    """A named participant on the bus; times are nanoseconds since 1970."""

    name: str  # full name: "/husky0/simple_controller"
    id: str  # unique for each run of each node
    host: str  # the name of its computer
    pid: int  # its process id there
    start_time: int = 0
    command: str = ""  # its command line
    tool: bool = False  # True for a command that observes the bus, not a part of the system
    ports: tuple[int, ...] = ()  # UDP ports it sends from, beside its announcements' port
    endpoints: tuple[Endpoint, ...] = ()
    sender: Sender | None = None  # of its announcements; None if the bus does not identify it
    last_announced: int = 0  # arrival of its last announcement; 0 for none
    stale: Staleness = Staleness.NOT
    busy: int = 0  # time spent in its callbacks, including those of timers [ns]
    sent: int = 0  # when its last announcement was sent, by its computer's clock; 0 if unknown
    errors: tuple[CallbackError, ...] = ()  # different errors of its callbacks, the newest last
    # Shortest time from the sending of an announcement to its arrival, by the two computers'
    # clocks [ns]: negative if its clock is ahead; None if unknown.
    lag: int | None = None
    is_recorded: bool = False  # True in a log: its pid means nothing on this computer
    # The relays between its bus and this one, the nearest first; empty for a node on this bus. For
    # a node behind a relay, computer, process and ports are those there, whatever their names.
    path: tuple[RelayStep, ...] = ()
    version: int = VERSION  # of the protocol that it speaks
    software: str = ""  # name and version of the library that announces it: "lcmtools 0.1.0"
    # False if only the head of its announcement could be read: endpoints are those of the messages
    # that it is seen to send, and ports, busy and errors are unknown.
    has_details: bool = True
    pid_namespace: int = 0  # in which its pid is valid, as each container has its own; 0 if unknown
    overflows: int = 0  # datagrams that its process's full receive buffers have lost, at most
    # What a relay or server has received from programs that are not nodes, by its own clock.
    observed: tuple["Traffic", ...] = ()
    full_lines: tuple[FullLine, ...] = ()  # of a relay or server; on Zenoh of any node

    def having(self, role: Role) -> tuple[Endpoint, ...]:
        """Return the endpoints of one role, sorted by topic."""
        ends = (end for end in self.endpoints if end.role is role)
        return tuple(sorted(ends, key=lambda end: end.topic))

    def senders(self) -> frozenset[Sender]:
        """Return all senders that are known to belong to this node."""
        if self.sender is None:
            return frozenset()
        address, name = self.sender.address, self.sender.name
        return frozenset({self.sender, *(Sender(address, port, name) for port in self.ports)})

    def time_there(self, now: int) -> int:
        """Return the time on the node's computer, used in its counters, at the time ``now`` here.

        Both [ns since 1970], and equal if the lag is unknown.
        """
        return now - (self.lag or 0)

    @property
    def is_counted(self) -> bool:
        """False for a node whose program counts neither messages nor its time in callbacks."""
        return self.has_details and (self.busy > 0 or any(end.is_counted for end in self.endpoints))

    @property
    def bus(self) -> str:
        """The bus that it is on, as named by its relay; "" for a node on this bus."""
        return self.path[-1].bus if self.path else ""

    @property
    def is_hidden(self) -> bool:
        """True if it is left out of lists."""
        return is_hidden(self.name)


class Traffic(NamedTuple):
    """One sender's observed messages on one channel; times are nanoseconds since 1970."""

    channel: str
    sender: Sender | None  # None if the bus does not identify it
    fingerprints: tuple[int, ...]  # in order of appearance; only a few if they keep changing
    messages: int
    bytes: int  # of their payloads
    first_time: int  # arrival of the first
    last_time: int
    types: tuple[str, ...] = ()  # types that the sender attaches to messages, if the bus can
    observer: str = ""  # the relay or server that observed them, as a node; "" for this program
    bus: str = ""  # the other bus on which it did so; "" for this bus

    def rate(self) -> float | None:
        """Return the messages per second, first to last; None before two messages."""
        if self.messages < 2 or self.last_time <= self.first_time:  # noqa: PLR2004 - an interval
            return None
        return (self.messages - 1) * 1e9 / (self.last_time - self.first_time)


Ends = tuple[tuple[NodeInfo, Endpoint], ...]
"""Endpoints with their nodes."""


class Topic(NamedTuple):
    """The known facts of one topic.

    ``foreign`` is the part of the traffic that no announced node has sent. If the bus does not
    identify senders, an announced publisher explains all of it, and so does a program that a relay
    or server has observed.
    """

    name: str
    publishers: Ends = ()  # announced
    subscribers: Ends = ()
    traffic: tuple[Traffic, ...] = ()  # by sender
    foreign: tuple[Traffic, ...] = ()

    @property
    def types(self) -> tuple[str, ...]:
        """The announced types, publishers' first, then those attached to messages, each once."""
        declared = [endpoint.type for _, endpoint in self.publishers + self.subscribers]
        named = (name for seen in self.traffic for name in seen.types)
        return tuple(dict.fromkeys(name for name in (*declared, *named) if name))

    @property
    def fingerprints(self) -> tuple[int, ...]:
        """The fingerprints seen on the channel, each once."""
        return tuple(dict.fromkeys(f for seen in self.traffic for f in seen.fingerprints))

    @property
    def is_latched(self) -> bool:
        """True if a living node sends its last message again to each new subscriber."""
        return any(endpoint.latched and not node.stale for node, endpoint in self.publishers)


class _Known(NamedTuple):
    nodes: tuple[NodeInfo, ...] = ()  # announced, sorted by name; stale ones included
    traffic: tuple[Traffic, ...] = ()  # on hidden channels too
    time: int = 0  # of this snapshot [ns since 1970]


class Graph(_Known):  # a separate class, to cache the table of topics
    """Everything that is known of a bus at one time."""

    def topic_names(self) -> list[str]:
        """Return all topics that are published, observed, or subscribed to by a node; sorted."""
        return [topic.name for topic in self.topics()]

    def topic(self, name: str) -> Topic:
        """Return the facts of one topic; empty if there are none."""
        return self._topics.get(name) or Topic(name)

    def topics(self) -> list[Topic]:
        """Return every topic, sorted, except those that only commands subscribe to."""
        return [
            one
            for one in self._topics.values()
            if one.publishers or one.traffic or any(not node.tool for node, _ in one.subscribers)
        ]

    def foreign(self) -> list[Traffic]:
        """Return the messages that no announced node has sent, without LCM's self tests.

        See ``Topic``.
        """
        topics = (one for one in self.topics() if one.name != SELF_TEST_CHANNEL)
        return [seen for one in topics for seen in one.foreign]

    def unexplained(self) -> list[NodeInfo]:
        """Return the living nodes, except commands, of which only the head is known."""
        return [one for one in self.nodes if not (one.has_details or one.stale or one.tool)]

    def named(self, name: str) -> list[NodeInfo]:
        """Return the nodes for a typed name: a full name, or the last part of one."""
        full = name if name.startswith("/") else f"/{name}"
        exact = [node for node in self.nodes if node.name == full]
        if exact or name.startswith("/"):
            return exact
        return [node for node in self.nodes if base_name_of(node.name) == name]

    @cached_property
    def _topics(self) -> dict[str, Topic]:
        ends: dict[tuple[str, Role], list[tuple[NodeInfo, Endpoint]]] = defaultdict(list)
        for node in self.nodes:
            for end in node.endpoints:
                ends[end.topic, end.role].append((node, end))
        traffic: dict[str, list[Traffic]] = defaultdict(list)
        for seen in self.traffic:
            traffic[seen.channel].append(seen)
        senders = {sender for node in self.nodes for sender in node.senders()}
        announced = {name for name, role in ends if role in (Role.PUBLISHER, Role.SUBSCRIBER)}
        found = {}
        for name in sorted(announced | traffic.keys()):
            sides = (Role.PUBLISHER, Role.SUBSCRIBER)
            publishers, subscribers = (tuple(ends.get((name, role), ())) for role in sides)
            every = tuple(traffic.get(name, ()))
            is_explained = publishers or any(seen.observer for seen in every)
            explained = senders | {None} if is_explained else senders
            foreign = tuple(seen for seen in every if seen.sender not in explained)
            found[name] = Topic(name, publishers, subscribers, every, foreign)
        return found
