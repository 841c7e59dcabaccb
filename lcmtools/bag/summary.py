"""The summary of a log: topics, counts, times, gaps and losses, from its index.

Must not know how it is shown. Of events not in the index, only the head is read.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain

from lcmtools.graph.builder import MOST_FINGERPRINTS, GraphBuilder
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.observe.reading.losses import Loss
from lcmtools.observe.reports.describe import Kinds, seen_kinds
from lcmtools.packages import provide_recorded_types
from lcmtools.wire.log_index import Block, ChannelCount, disorder
from lcmtools.wire.packet import Sender

_BINS = 60  # of a histogram
_SHORT = 8 << 20  # bytes up to which a log is read for its histogram

Progress = Callable[[int], object]  # takes the number of processed bytes of the log


@dataclass(slots=True)
class TopicSummary:
    """The messages of a topic in a log; times are nanoseconds since 1970."""

    name: str
    kinds: Kinds = ()  # its types as nodes announce them, else by fingerprint
    messages: int = 0
    bytes: int = 0  # of payloads
    first_time: int = 0
    last_time: int = 0
    longest_gap: int = 0  # longest time without a message, between the first and the last [ns]
    fingerprints: dict[int, None] = field(default_factory=dict)  # in order of appearance
    senders: dict[str, int] = field(default_factory=dict)  # messages by the sender's name

    @property
    def types(self) -> tuple[str, ...]:
        """All types that its messages may have, the likeliest first."""
        return tuple(dict.fromkeys(chain(*self.kinds)))

    @property
    def rate(self) -> float | None:
        """The messages per second, first to last; None before two messages."""
        span = self.last_time - self.first_time
        return (self.messages - 1) * 1e9 / span if span > 0 else None

    @property
    def mean_bytes(self) -> float:
        """The average size of a payload [byte]."""
        return self.bytes / self.messages if self.messages else 0.0

    def add(self, count: ChannelCount, senders: Mapping[int, str]) -> None:
        """Count the messages of one block, which must follow all earlier ones."""
        first, last = count.first_time, count.last_time
        self.longest_gap = max(self.longest_gap, count.longest_gap, first - self.last_time)
        self.first_time = min(self.first_time, first)
        self.last_time = max(self.last_time, last)
        self.messages += count.messages
        self.bytes += count.bytes
        if count.fingerprint is not None and len(self.fingerprints) < MOST_FINGERPRINTS:
            self.fingerprints[count.fingerprint] = None
        for number, messages in count.senders:
            if name := senders.get(number):
                self.senders[name] = self.senders.get(name, 0) + messages


@dataclass(frozen=True, slots=True)
class LogSummary:
    """The summary of a log; times are nanoseconds since 1970."""

    path: str
    bytes: int  # of the file
    indexed: int  # bytes that the index covers
    damaged: int  # bytes that belong to no event
    start: int  # start of the recording; 0 for an empty log
    end: int
    topics: tuple[TopicSummary, ...]  # by name
    nodes: tuple[str, ...]  # that announced themselves
    losses: Mapping[Sender, Loss]  # as the recorder saw them
    loss_times: tuple[tuple[int, Sender, Loss], ...]  # when they were found
    histogram: tuple[int, ...]  # numbers of messages in equal parts of the time
    disorder: int  # the most by which a message is earlier than one before it [ns]

    @property
    def messages(self) -> int:
        """The number of messages."""
        return sum(topic.messages for topic in self.topics)

    @property
    def duration(self) -> float:
        """The time from the first to the last message [s]."""
        return (self.end - self.start) / 1e9


def summarize(log: LogFile, progress: Progress = lambda _: None) -> LogSummary:
    """Return the summary of a log; ``progress`` is called while it is read."""
    builder = known_nodes(log)
    names = {number: one.name for number, one in log.index.senders.items()}
    topics: dict[str, TopicSummary] = {}
    blocks = []
    for block in log.blocks(builder.add):
        progress(block.end)
        blocks.append(block)
        for name, count in block.channels.items():
            topic = topics.get(name)
            if topic is None:
                topic = topics[name] = TopicSummary(
                    name, (), 0, 0, count.first_time, count.first_time
                )
            topic.add(count, names)
    for topic in topics.values():
        known = tuple((name,) for name in builder.types_of(topic.name))
        topic.kinds = known or seen_kinds(topic.fingerprints, topic.name)
    start, end = span_of(blocks)
    return LogSummary(
        str(log.path),
        log.size,
        log.index.end,
        log.size - sum(block.event_bytes for block in blocks),
        start,
        end,
        tuple(topics[name] for name in sorted(topics)),
        tuple(dict.fromkeys(node.name for node in builder.snapshot(end).nodes if not node.tool)),
        log.losses(),
        tuple(log.loss_times()),
        tuple(histogram(log, blocks, (start, end))),
        disorder(blocks),
    )


def known_nodes(log: LogFile) -> GraphBuilder:
    """Return the announcements of nodes in a log's index; also makes its types known."""
    provide_recorded_types(log.index.types.values())
    builder = GraphBuilder(is_log=True)
    for packet in log.announcements():
        builder.add(packet)
    return builder


def log_span(log: LogFile) -> tuple[int, int]:
    """Return the times of the first and the last message [ns since 1970]; 0, 0 for an empty log."""
    return span_of(list(log.blocks()))


def span_of(blocks: Sequence[Block]) -> tuple[int, int]:
    """Return the times of the first and the last message in blocks, as ``log_span``."""
    first = min((block.first_time for block in blocks), default=0)
    return first, max((block.last_time for block in blocks), default=0)


def histogram(
    log: LogFile, blocks: Sequence[Block], span: tuple[int, int], bins: int = _BINS
) -> list[int]:
    """Return the number of messages in each of ``bins`` equal parts of a time [ns since 1970].

    In a long log, a block's are assumed evenly spread; other times are left out.
    """
    found, width = [0.0] * bins, max(1, -(-(span[1] - span[0] + 1) // bins))
    for first, last, messages in _spreads(log, blocks):
        one, other = (first - span[0]) // width, (last - span[0]) // width
        # an index may have times that a damaged log no longer has
        for place in range(max(one, 0), min(other + 1, bins)):
            found[place] += messages / (other + 1 - one)
    return list(map(round, found))


def _spreads(log: LogFile, blocks: Sequence[Block]) -> Iterator[tuple[int, int, int]]:
    """Yield two times [ns], and the number of messages between them."""
    if log.size <= _SHORT:
        yield from ((event.time, event.time, 1) for event in log.events())
        return
    for block in blocks:
        messages = sum(one.messages for one in block.channels.values())
        yield block.first_time, block.last_time, messages
