"""The rows of the table: what is known of each channel, as plain values.

Must not know how a row is shown, nor where packets come from.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from lcmtools.cli.describe import listed_node
from lcmtools.graph.model import Graph, Role, Topic, Traffic
from lcmtools.messages.registry import candidates
from lcmtools.names import Pattern, is_hidden
from lcmtools.observe.activity import SILENT_AFTER, Activity, Flow, all_topics
from lcmtools.observe.senders import SenderNames
from lcmtools.wire.packet import Sender
from lcmtools.wire.sequence import Sequence as Numbers

_GONE = 10_000_000_000  # [ns] behind a channel's latest message: a sender that sends no more
_SHARED = 1  # more beginnings of a sender's numbers: several programs send from its port
_NOTHING = Flow(0, 0, 0)


@dataclass(frozen=True, slots=True)
class Row:
    """What is known of one channel.

    Attributes:
        channel: Its name.
        types: Its type: as nodes announce it, else all that the fingerprints may mean, the
            likeliest first; empty for unknown.
        is_announced: Whether nodes have announced ``types``.
        fingerprints: Those that were seen.
        messages: How many messages came.
        bytes: Bytes of their payloads.
        rate: Messages a second of late [Hz]; None where that is not known.
        jitter: The longest interval less the shortest [s]; None where that is not known.
        bandwidth: Bytes a second of late; None where that is not known.
        lost: How many messages of the channel's senders did not come, whatever the channel; None
            where the bus numbers none.
        loss: Their share of all that these senders have sent, 0 to 1; None as ``lost``.
        senders: Who publishes: nodes, else processes, else addresses.
        listeners: The nodes that subscribe; programs that are no nodes do not show.
        age: How long ago the last message came [s]; None before the first.
    """

    channel: str
    types: tuple[str, ...] = ()
    is_announced: bool = False
    fingerprints: tuple[int, ...] = ()
    messages: int = 0
    bytes: int = 0
    rate: float | None = None
    jitter: float | None = None
    bandwidth: float | None = None
    lost: int | None = None
    loss: float | None = None
    senders: tuple[str, ...] = ()
    listeners: tuple[str, ...] = ()
    age: float | None = None

    @property
    def is_silent(self) -> bool:
        """Whether nothing has come for three seconds, or ever."""
        return self.age is None or self.age * 1e9 > SILENT_AFTER


@dataclass(frozen=True, slots=True)
class Wanted:
    """Which channels have a row.

    Attributes:
        topics: Names, namespaces and patterns; none for all.
        hidden: Whether hidden names are meant too.
        namespace: Where relative names and patterns stand.
    """

    topics: tuple[str, ...] = ()
    hidden: bool = False
    namespace: str = "/"

    def has(self, name: str) -> bool:
        """Whether a channel is meant."""
        wanted = self.topics or ("",)
        patterns = (Pattern(text, self.namespace, hidden=self.hidden) for text in wanted)
        return any(pattern.covers(name) for pattern in patterns)


Losses = Mapping[Sender, tuple[int, int]]
"""Of each sender how many messages came, and how many did not."""


def losses(numbers: Mapping[Sender, Numbers], since: Losses | None = None) -> Losses:
    """What was lost of each sender, where its numbers tell that.

    Args:
        numbers: The numbers of each sender's messages.
        since: What was counted before counting began anew.
    """
    before = since or {}
    found = {}
    for sender, sequence in numbers.items():
        if sequence.restarts <= _SHARED:
            came, lost = before.get(sender, (0, 0))
            found[sender] = (max(0, sequence.messages - came), max(0, sequence.lost - lost))
    return found


class Rows:
    """Makes the rows of a bus.

    Args:
        wanted: Which channels have one.
        names: What senders are called.
    """

    def __init__(self, wanted: Wanted, names: SenderNames) -> None:
        self._wanted = wanted
        self._names = names
        self._is_wanted: dict[str, bool] = {}
        self._candidates: dict[int, list[str]] = {}

    def make(
        self, graph: Graph, activity: Activity, lost: Losses | None, now: int
    ) -> tuple[Row, ...]:
        """The rows, by the channels' names.

        Args:
            graph: What is known of the bus.
            activity: What goes on on its channels.
            lost: What was lost of each sender; None where the bus does not tell.
            now: The time, nanoseconds since 1970.
        """
        topics = [topic for topic in all_topics(graph) if self._has(topic.name)]
        self._names.learn(seen.sender for topic in topics for seen in topic.foreign)
        return tuple(
            self._row(topic, activity.flow(topic.name, now), lost, now) for topic in topics
        )

    def published(self, graph: Graph) -> list[str]:
        """The channels with a row that nodes publish on: some do only where somebody listens."""
        topics = {end.topic for node in graph.nodes for end in node.having(Role.PUBLISHER)}
        return sorted(filter(self._has, topics))

    def _has(self, name: str) -> bool:
        if name not in self._is_wanted:
            self._is_wanted[name] = self._wanted.has(name)
        return self._is_wanted[name]

    def _row(self, topic: Topic, flow: Flow | None, losses: Losses | None, now: int) -> Row:
        flow = flow or _NOTHING
        fingerprints = topic.fingerprints
        lost, loss = _loss(topic.traffic, losses)
        return Row(
            topic.name,
            topic.types or self._types(topic.name, fingerprints),
            bool(topic.types),
            fingerprints,
            flow.messages,
            flow.bytes,
            flow.rate,
            flow.jitter,
            flow.bandwidth,
            lost,
            loss,
            self._senders(topic),
            self._listeners(topic),
            max(0.0, (now - flow.last_time) / 1e9) if flow.messages else None,
        )

    def _types(self, channel: str, fingerprints: Sequence[int]) -> tuple[str, ...]:
        """What the messages may be; the type that a channel "name#package.Type" names first."""
        names = dict.fromkeys(name for number in fingerprints for name in self._named(number))
        said = channel.rpartition("#")[2].replace(".", "/") if "#" in channel else ""
        return tuple(sorted(names, key=lambda name: name != said))

    def _named(self, fingerprint: int) -> list[str]:
        if fingerprint not in self._candidates:
            self._candidates[fingerprint] = candidates(fingerprint)
        return self._candidates[fingerprint]

    def _senders(self, topic: Topic) -> tuple[str, ...]:
        nodes = [listed_node(node) for node, _ in topic.publishers if self._shows(node.name)]
        latest = max((seen.last_time for seen in topic.traffic), default=0)
        others = [
            self._names.name(seen.sender)
            for seen in topic.foreign
            if latest - seen.last_time < _GONE
        ]
        return tuple(dict.fromkeys([*nodes, *others]))

    def _listeners(self, topic: Topic) -> tuple[str, ...]:
        found = [listed_node(node) for node, _ in topic.subscribers if self._shows(node.name)]
        return tuple(dict.fromkeys(found))

    def _shows(self, node: str) -> bool:
        """Whether a node is named: not the commands that look, which are hidden."""
        return self._wanted.hidden or not is_hidden(node)


def _loss(traffic: Sequence[Traffic], losses: Losses | None) -> tuple[int | None, float | None]:
    """What was lost of the senders of a channel, and their share."""
    known = [
        losses[seen.sender]
        for seen in traffic
        if losses is not None and seen.sender is not None and seen.sender in losses
    ]
    if not known:
        return None, None
    came, lost = (sum(numbers) for numbers in zip(*known, strict=True))
    return lost, lost / (came + lost) if came + lost else 0.0


def matching(rows: Sequence[Row], text: str) -> list[Row]:
    """The rows that have a text in channel, type, sender or listener, in whatever case."""
    wanted = text.casefold()
    return [row for row in rows if any(wanted in part.casefold() for part in _texts(row))]


def in_order(rows: Sequence[Row], key: Callable[[Row], object], *, descending: bool) -> list[Row]:
    """The rows sorted by a column; those that have nothing in it last, equal ones by channel."""
    by_name = sorted(rows, key=lambda row: row.channel)
    known = [row for row in by_name if key(row) is not None]
    known.sort(key=key, reverse=descending)  # type: ignore[arg-type] # of one column, of one type
    return known + [row for row in by_name if key(row) is None]


def _texts(row: Row) -> tuple[str, ...]:
    return (row.channel, *row.types, *row.senders, *row.listeners)
