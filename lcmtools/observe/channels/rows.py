"""The channels of a bus as rows of a table. Must not know how a row is shown."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from itertools import compress
from operator import attrgetter

from lcmtools.bus.url import BusUrl
from lcmtools.errors import LcmtoolsError
from lcmtools.graph.builder import MOST_FLOWS
from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Topic
from lcmtools.messages.fields import fields
from lcmtools.messages.registry import message_class
from lcmtools.names import Pattern, is_hidden
from lcmtools.observe.channels.activity import SILENT_AFTER, Activity, Flow
from lcmtools.observe.reading.decoding import possible_types
from lcmtools.observe.reading.losses import Losses, total
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.observe.reading.senders import SenderNames, listening_programs, process_name
from lcmtools.observe.reports.describe import listed_node

_GONE = 10_000_000_000  # [ns] behind a channel's latest message: such a sender has stopped


@dataclass(frozen=True, slots=True)
class ChannelRow:
    """One channel of a bus."""

    channel: str  # its name
    # Its type as nodes announce it, else all types with its fingerprints, the likeliest first;
    # empty if unknown.
    types: tuple[str, ...] = ()
    is_announced: bool = False  # True if nodes have announced ``types``
    fingerprints: tuple[int, ...] = ()  # the fingerprints that were seen
    messages: int = 0  # the number of messages
    bytes: int = 0  # bytes of their payloads
    # Recent message rate [Hz]; see ``Flow``, also for ``jitter`` [s] and ``bandwidth`` [byte/s].
    rate: float | None = None
    jitter: float | None = None
    bandwidth: float | None = None
    # Messages that did not arrive from the channel's senders, on any channel; None if
    # unknown.
    lost: int | None = None
    # Their share of all that these senders have sent, 0 to 1; None if unknown.
    loss: float | None = None
    senders: tuple[str, ...] = ()  # the publishers: nodes, else processes, else addresses
    listeners: tuple[str, ...] = ()  # the nodes that subscribe; other programs do not show
    age: float | None = None  # time since the last message [s]; None before the first

    @property
    def is_silent(self) -> bool:
        """True if nothing has come for three seconds, or ever."""
        return self.age is None or self.age * 1e9 > SILENT_AFTER


@dataclass(frozen=True, slots=True)
class ChannelSelection:
    """The selection of channels that have a row."""

    topics: tuple[str, ...] = ()  # names, namespaces and patterns; none for all
    hidden: bool = False  # True for hidden names too
    namespace: str = "/"  # the namespace of relative names and patterns

    def has(self, name: str) -> bool:
        """Return whether a channel is selected."""
        patterns = (Pattern(t, self.namespace, hidden=self.hidden) for t in self.topics or ("",))
        return any(pattern.covers(name) for pattern in patterns)


class ChannelRows:
    """Makes the rows of a bus."""

    def __init__(self, selection: ChannelSelection, names: SenderNames) -> None:
        self._selection, self._names = selection, names
        self._has = lru_cache(MOST_FLOWS)(selection.has)
        self._possible = lru_cache(MOST_FLOWS)(possible_types)

    def make(
        self, graph: Graph, activity: Activity, lost: Losses, now: int
    ) -> tuple[ChannelRow, ...]:
        """Return the rows, sorted by channel, at a time in nanoseconds since 1970."""
        return self._make(self._selected(graph), activity, lost, now)

    def make_most(
        self, most: int, graph: Graph, activity: Activity, lost: Losses
    ) -> tuple[tuple[ChannelRow, ...], int]:
        """Return the rows of at most so many channels, and the number of those left out.

        Those that nodes have announced come first, then those with the latest messages.
        """
        topics = self._selected(graph)
        left_out = max(0, len(topics) - most)
        if left_out:
            kept = sorted(topics, key=_importance, reverse=True)[:most]
            topics = sorted(kept, key=attrgetter("name"))
        return self._make(topics, activity, lost, graph.time), left_out

    def _selected(self, graph: Graph) -> list[Topic]:
        return [topic for topic in graph.topics() if self._has(topic.name)]

    def _make(
        self, topics: Sequence[Topic], activity: Activity, lost: Losses, now: int
    ) -> tuple[ChannelRow, ...]:
        self._names.update(seen.sender for topic in topics for seen in topic.foreign)
        return tuple(self._row(topic, activity, lost, now) for topic in topics)

    def published(self, graph: Graph, *, large: bool = True) -> list[str]:
        """Return the selected channels on which nodes publish; some do so only for a subscriber.

        ``large`` includes those of images, clouds and other messages of variable size.
        """
        topics = (t for t in graph.topics() if t.publishers and self._has(t.name))
        return sorted(t.name for t in topics if large or not any(map(_is_large, t.types)))

    def _row(self, topic: Topic, activity: Activity, lost: Losses, now: int) -> ChannelRow:
        flow = activity.flow(topic.name, now) or Flow()
        fingerprints = topic.fingerprints
        loss = total((seen.sender for seen in topic.traffic), lost)
        return ChannelRow(
            topic.name,
            topic.types or self._types(topic.name, fingerprints),
            bool(topic.types),
            fingerprints,
            flow.messages,
            flow.bytes,
            flow.rate,
            flow.jitter,
            flow.bandwidth,
            loss.lost if loss else None,
            loss.share if loss else None,
            self._senders(topic),
            self._names_of(topic.subscribers),
            max(0.0, (now - flow.last_time) / 1e9) if flow.messages else None,
        )

    def _types(self, channel: str, fingerprints: Sequence[int]) -> tuple[str, ...]:
        """The types that messages may have, the likeliest first."""
        names = (name for number in fingerprints for name in self._possible(number, channel))
        return tuple(dict.fromkeys(names))

    def _senders(self, topic: Topic) -> tuple[str, ...]:
        latest = max((seen.last_time for seen in topic.traffic), default=0)
        others = [seen.sender for seen in topic.foreign if latest - seen.last_time < _GONE]
        nodes = self._names_of(topic.publishers)
        return tuple(dict.fromkeys([*nodes, *map(self._names.name, others)]))

    def _names_of(self, ends: Sequence[tuple[NodeInfo, Endpoint]]) -> tuple[str, ...]:
        """The nodes' names, without hidden ones, as commands are."""
        shown = (node for node, _ in ends if self._selection.hidden or not is_hidden(node.name))
        return tuple(dict.fromkeys(map(listed_node, shown)))


def _importance(topic: Topic) -> tuple[bool, int]:
    return bool(topic.publishers), max((seen.last_time for seen in topic.traffic), default=0)


@cache
def _is_large(name: str) -> bool:
    """Return whether messages of a type may be large: they have a byte array of variable length."""
    try:
        parts = fields(message_class(name))
    except LcmtoolsError:
        return False
    return any(part.is_bytes and isinstance(part.dimensions[-1], str) for part in parts)


def survey(
    monitor: BusMonitor, selection: ChannelSelection, wait: float
) -> tuple[Graph, tuple[ChannelRow, ...]]:
    """Return the graph and the rows of a bus after ``wait`` seconds; for a log, of all of it."""
    rows = ChannelRows(selection, SenderNames())
    monitor.listen_to(rows.published(monitor.discover()))
    activity = Activity()
    graph = monitor.settle(wait=wait, count=activity.add)
    return graph, rows.make(graph, activity, monitor.losses(), graph.time)


def plain_listeners(graph: Graph, url: BusUrl) -> list[str]:
    """Return the programs of this computer that receive from the bus and are not nodes."""
    found = listening_programs(graph, url) or []
    return [process_name(program.process) for program in found if program.process]


def matching(rows: Sequence[ChannelRow], text: str) -> list[ChannelRow]:
    """Return the rows that have a text in channel, type, sender or listener, ignoring case."""
    wanted = text.casefold()
    texts = ((row.channel, *row.types, *row.senders, *row.listeners) for row in rows)
    found = (any(wanted in part.casefold() for part in parts) for parts in texts)
    return list(compress(rows, found))


def in_order(
    rows: Sequence[ChannelRow], key: Callable[[ChannelRow], object], *, descending: bool
) -> list[ChannelRow]:
    """Return the rows sorted by a key; rows without a key come last, equal ones by channel."""
    by_name = sorted(rows, key=lambda row: row.channel)
    known = [row for row in by_name if key(row) is not None]
    known.sort(key=key, reverse=descending)  # type: ignore[arg-type] # of one column, of one type
    return known + [row for row in by_name if key(row) is None]
