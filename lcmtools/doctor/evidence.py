"""The evidence of one look at a bus: plain values, which a file can hold (``saved``).

Belongs here: what the rules may look at. Must not read anything, nor judge.
"""

from collections.abc import Callable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field
from functools import wraps
from typing import TypeVar

from lcmtools.graph.model import Graph, Node
from lcmtools.wire.packet import Sender

_T = TypeVar("_T")
_BUSY = 0.25  # of the time that programs wait for a processor is a busy computer


@dataclass(frozen=True, slots=True)
class Host:
    """The parts of this computer that bear on the bus; empty where not known."""

    uid: int = 0  # of the user who looks
    interface: str = ""  # to which the route to the group leads ("lo", "eth0")
    is_up: bool = True  # the interface; so are the next ones
    can_multicast: bool = True
    has_link: bool = True
    joined: tuple[str, ...] = ()  # interfaces on which any program has joined the group
    rp_filter: int = 0  # 1 is strict
    rp_filter_drops: int = 0  # datagrams that it dropped, during the look
    speed_mbit: int = 0  # [Mbit/s]
    is_wireless: bool = False
    most_receive_buffer: int = 0  # [byte] that a socket may request (rmem_max)
    firewall: str = ""  # the name of one that is enabled
    firewall_chain: str = ""  # where it refuses: "inet filter input" of nftables, "INPUT"
    container: str = ""  # "container" or "WSL"
    reassembly_failures: int = 0  # IP datagrams with fragments missing, during the look
    environment: tuple[str, ...] = ()  # faults of variables and Python packages, one line each
    others: tuple[str, ...] = ()  # further interfaces with routes, but for lo
    firewall_unknown: str = ""  # the reason why it is not known whether there is a firewall
    is_virtual: bool = False  # the interface ends in another network of this computer
    bridge: str = ""  # the bridge on the route, if it snoops IGMP and sends no queries
    large_bytes: int = 0  # size of the large message that wtf sent to itself
    large_problem: str = ""  # the reason why it did not come back
    send_problem: str = ""  # the reason why nothing can be sent with the bus's own ttl
    send_remedy: str = ""  # a cure for that
    has_sockets: bool = True  # the system lists its sockets (/proc/net/udp)


@dataclass(frozen=True, slots=True)
class HostClock:
    """The clock of another computer, compared with this one's."""

    host: str
    address: str
    lag: float  # [s] least delay of its announcements by both clocks; negative: its clock is ahead
    nodes: tuple[str, ...]  # from whose announcements this is known


@dataclass(frozen=True, slots=True)
class Listener:
    """A socket of this computer that receives from the bus, and its state during the look."""

    name: str  # of its node or program, for people
    pid: int | None  # None where the process is not known
    uid: int
    drops: int = 0  # datagrams that the kernel dropped meanwhile, because its buffer was full
    queued_bytes: int = 0  # in its buffer at the end, with the kernel's overhead
    was_queued_bytes: int = 0  # at the start
    buffer_bytes: int | None = None  # None where not known
    state: str = ""  # of the process, as ps shows it ("T" is stopped); "" where not known
    is_tool: bool = False  # a command of lcmtools that looks, not a part of the system
    is_node: bool = False  # has a filter that drops malformed datagrams, which count as drops
    joined: tuple[str, ...] = ()  # interfaces on which it is in the bus's group, where known


@dataclass(frozen=True, slots=True)
class SenderFacts:
    """A sender, as it was seen."""

    sender: Sender
    name: str  # its node or program, for people
    is_local: bool = True  # on this computer
    messages: int = 0  # received
    lost: int = 0  # by its sequence numbers
    ttl: int | None = None  # of its datagrams; None where not known
    uid: int | None = None  # the user of a local one, where known
    paces: bool = False  # spreads the fragments of large messages, as nodes of lcmtools do
    process_age: float = 0.0  # [s] since its process was started; 0 where not known
    average_rate: float = 0.0  # [Hz] of its messages since then, by their numbers


@dataclass(frozen=True, slots=True)
class Stream:
    """The messages of one sender on one channel during the look."""

    channel: str
    sender: Sender | None  # None where not known
    name: str  # the sender, for people
    times: tuple[int, ...]  # [ns since 1970] of the first thousands of arrivals
    largest: int = 0  # [byte] the largest payload
    bytes: int = 0  # of all payloads
    is_cut: bool = False  # there were more arrivals than times
    pid: int | None = None  # the sender's process on this computer, where known
    has_ended: bool = False  # the sender, a program of this computer
    format: str = ""  # "JSON", "protobuf", ... of payloads that are likely no LCM messages
    doubled: int = 0  # messages that came again, with the same number
    repeated: int = 0  # messages that another sender had sent before, to the byte


@dataclass(frozen=True, slots=True)
class Publication:
    """A sender's messages on a topic in earlier looks of ``--watch``."""

    topic: str
    sender: Sender | None
    name: str  # the sender, for people
    pid: int | None  # the sender's process on this computer, where known
    rate: float  # [Hz] the fastest so far
    gap: float  # [s] the longest between the latest messages
    last_time: int  # [ns since 1970] of the newest message


@dataclass(frozen=True, slots=True)
class Oddity:
    """A value in the messages of a topic that looks wrong."""

    kind: str  # "not-finite", "quaternion", "covariance", "nsec", "future", "old", "replayed",
    # "boot", "unit" or "undecodable"
    topic: str
    name: str  # the sender, for people
    text: str  # the field's path, and what is odd about it
    count: int = 1  # messages that have it


@dataclass(frozen=True, slots=True)
class FrameParent:
    """A coordinate frame and the one that a transform puts it into."""

    tree: str  # the namespace of the topic: each has frames of its own
    child: str
    parent: str
    name: str  # the sender, for people


@dataclass(frozen=True, slots=True)
class LogLine:
    """A warning or an error that came on ``/rosout``."""

    node: str  # that wrote it
    level: str  # "warning", "error" or "fatal"
    text: str  # its first line, shortened
    count: int = 1  # times that it came


@dataclass(frozen=True, slots=True)
class SimulatedClock:
    """The pace of simulated time, by ``/clock``."""

    name: str  # of its publisher
    ratio: float | None  # simulated seconds in a second; None where they do not only rise
    target: float | None = 1.0  # by its command line; None: as fast as it can
    busy: float | None = None  # share of time its process computed or waited for a processor
    jumps: int = 0  # ticks that are earlier than the one before


@dataclass(frozen=True, slots=True)
class LcmProcess:
    """A process of this user that uses LCM."""

    pid: int
    command: str
    bus: str = ""  # "239.255.76.67:7668" or a URL where it is on another bus; "" on this one
    variable: str = ""  # its LCM_DEFAULT_URL or LCMTOOLS_DOMAIN, as NAME=VALUE
    open_files: int = 0
    most_files: int = 0  # that it may have open
    state: str = ""  # as ps shows it ("T" is stopped)
    topics: tuple[str, ...] = ()  # published on its bus, if that was looked at
    is_guess: bool = False  # the bus is the one that its code names
    awaited: tuple[str, ...] = ()  # topics of this bus that its node waits for on the other one


@dataclass(frozen=True, slots=True)
class RelayEnd:
    """One of the two ends of a relay, as it reports itself."""

    relay: str
    host: str
    bus: str  # as a person calls it
    trouble: str = ""  # the reason why the bus cannot be reached; "" for none
    dropped: int = 0  # messages for the bus that were dropped during the look
    commands: tuple[str, ...] = ()  # of this bus, that do not pass and that a node there waits for
    stands_by: bool = False


@dataclass(frozen=True)
class Evidence:
    """Everything that the rules may look at. It has no slots: ``derived`` keeps values in it."""

    url: str
    bus_problem: str = ""  # the reason why the bus cannot be used at all
    bus_remedy: str = ""  # a cure for that
    ttl: int = 0  # of this user's datagrams
    graph: Graph = field(default_factory=Graph)  # at the end of the look
    before: Graph = field(default_factory=Graph)  # at its start
    listened: float = 0.0  # [s] the duration of the look
    malformed: Sequence[tuple[str, str]] = ()  # senders of datagrams that are not LCM's; reasons
    own_drops: int = 0  # datagrams that wtf itself was too slow for
    senders: Sequence[SenderFacts] = ()
    streams: Sequence[Stream] = ()
    remembered: Sequence[Publication] = ()  # of senders that may still be there
    listeners: Sequence[Listener] = ()  # on this computer
    oddities: Sequence[Oddity] = ()
    frames: Sequence[FrameParent] = ()
    logs: Sequence[LogLine] = ()
    clock: SimulatedClock | None = None  # None without a simulator
    processes: Sequence[LcmProcess] = ()
    host: Host = field(default_factory=Host)
    stale_published: AbstractSet[str] = frozenset()  # topics of stale nodes of this computer
    stale_subscribed: AbstractSet[str] = frozenset()
    processor_wait: float = 0.0  # [s] the longest time that a program waited for a processor
    users: Mapping[int, str] = field(default_factory=dict)  # names by number
    clocks: Sequence[HostClock] = ()  # of other computers
    remote: AbstractSet[str] = frozenset()  # ids of the nodes on other computers
    relays: Sequence[RelayEnd] = ()
    damaged_bytes: int = 0  # of the log, which do not belong to any message

    def own_nodes(self) -> list[Node]:
        """The nodes of this computer: only their process numbers mean anything here."""
        return [node for node in self.graph.nodes if node.id not in self.remote]

    def wait_share(self) -> float:
        """The share of time that programs waited for a processor, where it is considerable."""
        share = min(1.0, self.processor_wait / self.listened) if self.listened else 0.0
        return share if share > _BUSY else 0.0

    def has_others(self) -> bool:
        """Return whether other computers are seen to take part."""
        return any(not sender.is_local for sender in self.senders)


def derived(compute: Callable[[Evidence], _T]) -> Callable[[Evidence], _T]:
    """Compute a function of evidence once, however many rules need it."""

    @wraps(compute)
    def once(evidence: Evidence) -> _T:
        known = vars(evidence)
        if compute.__qualname__ not in known:
            known[compute.__qualname__] = compute(evidence)
        value: _T = known[compute.__qualname__]
        return value

    return once


@derived
def sender_names(evidence: Evidence) -> dict[Sender | None, str]:
    """The names of the senders, for people."""
    return {one.sender: one.name for one in evidence.senders}


@derived
def channel_names(evidence: Evidence) -> dict[str, str]:
    """The name of a sender of each channel, for people."""
    return {stream.channel: stream.name for stream in evidence.streams}
