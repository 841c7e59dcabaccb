"""The evidence of one look at a bus: plain values, which a file can hold (``saved``).

Belongs here: the input of the rules. Must neither read anything nor judge.
"""

from collections.abc import Callable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field
from functools import wraps
from typing import TypeVar

from lcmtools.graph.command_line import short_name
from lcmtools.graph.model import Graph, NodeInfo
from lcmtools.wire.packet import Sender

_T = TypeVar("_T")
_BUSY = 0.25  # share of time that programs wait for a processor on a busy computer


@dataclass(frozen=True, slots=True)
class Host:
    """The state of this computer that affects the bus; unknown values are empty."""

    uid: int = 0  # of the user who runs wtf
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
    firewall: str = ""  # the name of the enabled one
    firewall_chain: str = ""  # it drops datagrams: "inet filter input" of nftables, "INPUT"
    container: str = ""  # "container" or "WSL"
    reassembly_failures: int = 0  # IP datagrams with fragments missing, during the look
    environment: tuple[str, ...] = ()  # faults of variables and Python packages, one line each
    others: tuple[str, ...] = ()  # other interfaces with routes, except lo
    firewall_unknown: str = ""  # the reason why the firewall is not known
    is_virtual: bool = False  # the interface ends in another network of this computer
    bridge: str = ""  # the bridge on the route, if it snoops IGMP and sends no queries
    large_bytes: int = 0  # size of the large message that wtf sent to itself
    large_problem: str = ""  # the reason why it did not come back
    send_problem: str = ""  # the reason why nothing can be sent with the bus's own ttl
    send_remedy: str = ""  # the remedy
    has_sockets: bool = True  # the system lists its sockets (/proc/net/udp)


@dataclass(frozen=True, slots=True)
class HostClock:
    """The clock of another computer, compared with this one's."""

    host: str
    address: str  # "" behind a relay
    lag: float  # [s] least delay of its announcements by both clocks; negative: its clock is ahead
    nodes: tuple[str, ...]  # from whose announcements this is known


@dataclass(frozen=True, slots=True)
class Listener:
    """A socket of this computer that receives from the bus, and its state during the look."""

    name: str  # of its node or program, as it is displayed
    pid: int | None  # None if the process is unknown
    uid: int
    drops: int = 0  # datagrams that the kernel dropped meanwhile, because its buffer was full
    queued_bytes: int = 0  # in its buffer at the end, with the kernel's overhead
    was_queued_bytes: int = 0  # at the start
    buffer_bytes: int | None = None  # None if unknown
    state: str = ""  # of the process, as ps shows it ("T" is stopped); "" where not known
    is_tool: bool = False  # a command of lcmtools that only observes
    is_node: bool = False  # has a filter that drops malformed datagrams, which count as drops
    joined: tuple[str, ...] = ()  # interfaces on which it is in the bus's group, if known
    interpreter: str = ""  # of its program: "python3.11", "java"; "" for none
    is_unfiltered: bool = False  # a socket of lcmtools whose filter the kernel refused
    hangs: bool = False  # liblcm has had messages for it since the start, and it read none


@dataclass(frozen=True, slots=True)
class SenderFacts:
    """A sender and its messages during the look."""

    sender: Sender
    name: str  # of its node or program, as it is displayed
    is_local: bool = True  # on this computer
    messages: int = 0  # received
    lost: int = 0  # by its sequence numbers
    ttl: int | None = None  # of its datagrams; None if unknown
    uid: int | None = None  # the user of a local one, if known
    paces: bool = False  # spreads the fragments of large messages, as nodes of lcmtools do
    process_age: float = 0.0  # [s] since its process was started; 0 if unknown
    average_rate: float = 0.0  # [Hz] of its messages since then, by their numbers


@dataclass(frozen=True, slots=True)
class Stream:
    """The messages of one sender on one channel during the look."""

    channel: str
    sender: Sender | None  # None if unknown
    name: str  # the displayed name of the sender
    times: tuple[int, ...]  # [ns since 1970] of the first thousands of arrivals
    largest: int = 0  # [byte] the largest payload
    bytes: int = 0  # of all payloads
    is_cut: bool = False  # there were more arrivals than times
    pid: int | None = None  # the sender's process on this computer, if known
    has_ended: bool = False  # the sender, a program of this computer
    format: str = ""  # "JSON", "protobuf", ... of payloads that are likely no LCM messages
    doubled: int = 0  # messages that arrived twice with the same number
    repeated: int = 0  # messages that another sender sent before, with the same bytes
    programs: int = 1  # that send it from one port, by their numbers


@dataclass(frozen=True, slots=True)
class Publication:
    """A sender's messages on a topic in earlier looks of ``--watch``."""

    topic: str
    sender: Sender | None
    name: str  # the displayed name of the sender
    pid: int | None  # the sender's process on this computer, if known
    rate: float  # [Hz] the fastest so far
    gap: float  # [s] the longest between the latest messages
    last_time: int  # [ns since 1970] of the newest message


@dataclass(frozen=True, slots=True)
class Oddity:
    """A value in the messages of a topic that looks wrong."""

    kind: str  # the key of its title in ``rules.content``, or "not-finite", "undecodable"
    topic: str
    name: str  # the displayed name of the sender
    text: str  # the field's path, and what is odd about it
    count: int = 1  # messages that have it


@dataclass(frozen=True, slots=True)
class FrameParent:
    """A coordinate frame and its parent, by a transform."""

    tree: str  # the namespace of the topic: each has frames of its own
    child: str
    parent: str
    name: str  # the displayed name of the sender


@dataclass(frozen=True, slots=True)
class LogLine:
    """A warning or an error on ``/rosout``."""

    node: str  # the node that logged it
    level: str  # "warning", "error" or "fatal"
    text: str  # its first line, shortened
    count: int = 1  # number of times


@dataclass(frozen=True, slots=True)
class SimulatedClock:
    """The rate of simulated time, by ``/clock``."""

    name: str  # of its publisher
    ratio: float | None  # simulated seconds per second; None if time jumps back
    target: float | None = 1.0  # by its command line; None: as fast as possible
    busy: float | None = None  # share of time its process computed or waited for a processor
    jumps: int = 0  # ticks that are earlier than their predecessor


@dataclass(frozen=True, slots=True)
class LcmProcess:
    """A process of this user that uses LCM."""

    pid: int
    command: str
    bus: str = ""  # "239.255.76.67:7668" or a URL where it is on another bus; "" on this one
    variable: str = ""  # its LCM_DEFAULT_URL or LCMTOOLS_DOMAIN, as NAME=VALUE
    open_files: int = 0
    most_files: int = 0  # the limit of open files
    state: str = ""  # as ps shows it ("T" is stopped)
    topics: tuple[str, ...] = ()  # published on its bus, if that was observed
    is_guess: bool = False  # the bus comes from its code
    awaited: tuple[str, ...] = ()  # topics of this bus that its node waits for on the other one


@dataclass(frozen=True, slots=True)
class RelayEnd:
    """One of the two ends of a relay, by the relay's report."""

    relay: str
    host: str
    bus: str  # as the user wrote it
    trouble: str = ""  # the reason why the bus cannot be reached; "" for none
    dropped: int = 0  # messages for the bus that were dropped during the look
    commands: tuple[str, ...] = ()  # topics that do not pass and that a node on this bus waits for
    stands_by: bool = False
    id: str = ""


@dataclass(frozen=True)
class Evidence:
    """The input of the rules. It has no slots because ``derived`` stores values in it."""

    url: str
    bus_problem: str = ""  # the reason why the bus cannot be used at all
    bus_remedy: str = ""  # the remedy
    ttl: int = 0  # of this user's datagrams
    graph: Graph = field(default_factory=Graph)  # at the end of the look
    before: Graph = field(default_factory=Graph)  # at its start
    listened: float = 0.0  # [s] the duration of the look
    malformed: Sequence[tuple[str, str]] = ()  # senders of datagrams that are not LCM's; reasons
    own_drops: int = 0  # datagrams that wtf itself was too slow to receive
    senders: Sequence[SenderFacts] = ()
    streams: Sequence[Stream] = ()
    remembered: Sequence[Publication] = ()  # publishers of earlier looks that may still run
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
    waits: Mapping[int, float] = field(default_factory=dict)  # [s] the same, by process
    users: Mapping[int, str] = field(default_factory=dict)  # names by number
    clocks: Sequence[HostClock] = ()  # of other computers
    remote: AbstractSet[str] = frozenset()  # ids of the nodes on other computers
    relays: Sequence[RelayEnd] = ()
    damaged_bytes: int = 0  # of the log, which do not belong to any message

    def own_nodes(self) -> list[NodeInfo]:
        """Return the nodes of this computer: only their process numbers are valid here."""
        return [node for node in self.graph.nodes if node.id not in self.remote]

    def plain_programs(self) -> list[LcmProcess]:
        """Return the programs on this bus that may publish without being announced.

        A command of lcmtools that publishes is announced.
        """
        nodes = {node.pid for node in self.own_nodes()}
        on_bus = (one for one in self.processes if not one.bus and one.pid not in nodes)
        return [one for one in on_bus if short_name(one.command) != "lcmtools"]

    def wait_share(self) -> float:
        """Return the share of time that programs waited for a processor; 0 if it is small."""
        share = min(1.0, self.processor_wait / self.listened) if self.listened else 0.0
        return share if share > _BUSY else 0.0

    def has_others(self) -> bool:
        """Return whether another computer sends on the bus."""
        return any(not sender.is_local for sender in self.senders)


def derived(compute: Callable[[Evidence], _T]) -> Callable[[Evidence], _T]:
    """Cache a function of evidence in the evidence, for all rules that need it."""

    @wraps(compute)
    def once(evidence: Evidence) -> _T:
        known, name = vars(evidence), f"{compute.__module__}.{compute.__qualname__}"
        if name not in known:
            known[name] = compute(evidence)
        value: _T = known[name]
        return value

    return once


@derived
def sender_names(evidence: Evidence) -> dict[Sender | None, str]:
    """Return the displayed names of the senders."""
    return {one.sender: one.name for one in evidence.senders}


@derived
def channel_names(evidence: Evidence) -> dict[str, str]:
    """Return the displayed name of one sender of each channel."""
    return {stream.channel: stream.name for stream in evidence.streams}
