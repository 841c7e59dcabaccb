"""Evidence, findings and rules: plain values."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field
from enum import IntEnum

from lcmtools.doctor.computers import Host, HostClock
from lcmtools.graph.model import Graph, Node
from lcmtools.wire.packet import Sender


class Severity(IntEnum):
    """How grave a finding is; the greatest one is the exit code of ``wtf``, a note counts 0."""

    NOTE = 0
    WARNING = 1
    ERROR = 2


@dataclass(frozen=True, slots=True)
class Listener:
    """A socket of this computer that receives from the bus, and how it fared while wtf listened.

    Attributes:
        name: Its node or program, for people.
        pid: Its process; None where that is not known.
        uid: The user it belongs to.
        drops: Datagrams that the kernel dropped meanwhile, because its buffer was full.
        queued_bytes: What waited in the buffer at the end, with the kernel's overhead.
        was_queued_bytes: What waited at the start.
        buffer_bytes: How large the buffer is; None where the system does not tell.
        state: Of the process, as ps shows it ("T" is stopped); "" where that is not known.
        is_tool: A command of lcmtools that looks, not a part of the system.
        is_node: A node's, before which a filter drops malformed datagrams; it counts these too.
    """

    name: str
    pid: int | None
    uid: int
    drops: int = 0
    queued_bytes: int = 0
    was_queued_bytes: int = 0
    buffer_bytes: int | None = None
    state: str = ""
    is_tool: bool = False
    is_node: bool = False


@dataclass(frozen=True, slots=True)
class SenderFacts:
    """What was seen of one sender.

    Attributes:
        sender: Its address.
        name: Its node or program, for people.
        is_local: It is on this computer.
        messages: How many came.
        lost: How many did not, by its numbers.
        ttl: How many routers its datagrams may pass; None where that is not known.
        uid: The user of a local one, where that is known.
        paces: It spreads the fragments of large messages, as nodes of lcmtools do.
    """

    sender: Sender
    name: str
    is_local: bool = True
    messages: int = 0
    lost: int = 0
    ttl: int | None = None
    uid: int | None = None
    paces: bool = False


@dataclass(frozen=True, slots=True)
class Stream:
    """The messages of one sender on one channel, while wtf listened.

    Attributes:
        channel: The channel.
        sender: Who; None where the bus does not say.
        name: The sender for people.
        times: Arrivals, nanoseconds since 1970; the first thousands.
        is_cut: There were more arrivals, of which the times are not known.
        largest: Bytes of the largest payload.
        bytes: Of all payloads.
        pid: The sender's process, where it is one of this computer and known.
    """

    channel: str
    sender: Sender | None
    name: str
    times: tuple[int, ...]
    largest: int = 0
    bytes: int = 0
    is_cut: bool = False
    pid: int | None = None


@dataclass(frozen=True, slots=True)
class Oddity:
    """Something odd within the messages of a topic.

    Attributes:
        kind: "not-finite", "quaternion", "covariance", "nsec", "future", "old", "boot" or
            "undecodable".
        topic: The channel.
        name: The sender for people.
        text: What and where: the field's path.
        count: In how many messages.
    """

    kind: str
    topic: str
    name: str
    text: str
    count: int = 1


@dataclass(frozen=True, slots=True)
class SimClock:
    """How simulated time went on, by ``/clock``.

    Attributes:
        name: Who publishes it.
        ratio: Simulated seconds in a second.
        wanted: What the program's command line asks for; None where it asks for as much as can be.
        busy: Which share of the time its process computed, or waited for a processor; None where
            that is not known.
    """

    name: str
    ratio: float
    wanted: float | None = 1.0
    busy: float | None = None


@dataclass(frozen=True, slots=True)
class LcmProcess:
    """A process of this user that has something to do with LCM.

    Attributes:
        pid: Its number.
        command: Its command line.
        bus: Where it is ("239.255.76.67:7668"), on another bus than the one looked at; "" on it.
        variable: Its LCM_DEFAULT_URL or LCMTOOLS_DOMAIN, as NAME=VALUE; "" without.
        open_files: How many it has open.
        most_files: How many it may.
        state: As ps shows it ("T" is stopped).
        topics: What is published on its bus, where that is another one and something is missed.
    """

    pid: int
    command: str
    bus: str = ""
    variable: str = ""
    open_files: int = 0
    most_files: int = 0
    state: str = ""
    topics: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Evidence:
    """Everything that the rules may look at.

    Attributes:
        url: The bus.
        bus_problem: Why the bus cannot be used at all; "" when it can.
        bus_remedy: What to type against that.
        ttl: How many routers this user's datagrams may pass.
        graph: What is known of the bus.
        before: The same when wtf began to listen.
        listened: How long the traffic was watched [s].
        malformed: Senders of datagrams that are none of LCM's, with what is wrong.
        own_drops: Datagrams that wtf itself was too slow for.
        senders: Who sent.
        streams: What was sent.
        listeners: Who receives on this computer.
        oddities: What was odd within messages.
        clock: How simulated time goes on; None without a simulator.
        processes: This user's processes that use LCM.
        host: This computer.
        hushed: What stale nodes of this computer published.
        deafened: What stale nodes of this computer subscribed to.
        waited: How long programs of the bus had to wait for a processor meanwhile, at most [s].
        users: What the users of this computer are called, those who appear here, by number.
        clocks: The other computers' clocks, as far as their nodes tell.
        remote: The ids of the nodes on other computers.
    """

    url: str
    bus_problem: str = ""
    bus_remedy: str = ""
    ttl: int = 0
    graph: Graph = field(default_factory=Graph)
    before: Graph = field(default_factory=Graph)
    listened: float = 0.0
    malformed: Sequence[tuple[str, str]] = ()
    own_drops: int = 0
    senders: Sequence[SenderFacts] = ()
    streams: Sequence[Stream] = ()
    listeners: Sequence[Listener] = ()
    oddities: Sequence[Oddity] = ()
    clock: SimClock | None = None
    processes: Sequence[LcmProcess] = ()
    host: Host = field(default_factory=Host)
    hushed: AbstractSet[str] = frozenset()
    deafened: AbstractSet[str] = frozenset()
    waited: float = 0.0
    users: Mapping[int, str] = field(default_factory=dict)
    clocks: Sequence[HostClock] = ()
    remote: AbstractSet[str] = frozenset()

    def own_nodes(self) -> list[Node]:
        """The nodes of this computer: only their process numbers mean anything here."""
        return [node for node in self.graph.nodes if node.id not in self.remote]


@dataclass(frozen=True, slots=True)
class Finding:
    """Something that is, or may be, wrong.

    Attributes:
        rule: The rule's id ("unconnected-subscriptions").
        severity: How grave.
        text: One line.
        items: Lines below it, indented as they should appear.
        remedies: What to type or change, one line each.
    """

    rule: str
    severity: Severity
    text: str
    items: tuple[str, ...] = ()
    remedies: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Unchecked:
    """Something that could not be looked at.

    Attributes:
        rule: The rule that would need it.
        why: Why not, and what would help.
    """

    rule: str
    why: str


Check = Callable[[Evidence], Iterator[Finding]]
"""Looks at the evidence and yields what it finds."""


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule of ``wtf``.

    Attributes:
        id: Its name ("unconnected-subscriptions").
        severity: How grave its gravest finding is.
        explanation: A paragraph: what it looks at, and why that matters.
        remedy: What helps in general; findings say it more exactly.
        check: The rule itself.
    """

    id: str
    severity: Severity
    explanation: str
    remedy: str
    check: Check

    @property
    def title(self) -> str:
        """The first sentence of the explanation."""
        return self.explanation.partition(". ")[0].rstrip(".")


def rule(identifier: str, severity: Severity, remedy: str) -> Callable[[Check], Rule]:
    """Make a check a rule; its docstring is the explanation."""

    def make(check: Check) -> Rule:
        explanation = " ".join((check.__doc__ or "").split())
        return Rule(identifier, severity, explanation, remedy, check)

    return make
