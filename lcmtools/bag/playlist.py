"""The playlist: the messages of logs in order of time, each with its target topic.

Belongs here: which channels are played, and under which names. Must not know buses and clocks.
"""

import heapq
import sys
from bisect import bisect_right
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from operator import itemgetter
from pathlib import Path
from typing import NamedTuple

from lcmtools.arguments import NodeArguments
from lcmtools.bag.edits import TopicChoice
from lcmtools.bag.latched import LatchedTopics, untold
from lcmtools.bag.summary import histogram, span_of
from lcmtools.bag.summary_report import span_text
from lcmtools.clock import CLOCK_TOPIC, NANOSECONDS
from lcmtools.errors import LcmtoolsError
from lcmtools.forks import cached_property
from lcmtools.graph.builder import GraphBuilder
from lcmtools.graph.protocol import NODE_CHANNEL
from lcmtools.names import (
    Resolver,
    check_length,
    is_hidden,
    is_utf_8,
    resolve_namespace,
    spellings,
)
from lcmtools.observe.reading.decoding import possible_types
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.packages import provide_recorded_types
from lcmtools.wire.log_events import Event
from lcmtools.wire.log_index import Block, disorder
from lcmtools.wire.packet import Packet, Sender

_STEP = NANOSECONDS  # times that go back by more are a step, after which playing goes on at once
_MOST_PARTS = 8  # that times may belong to, one message to this and the next to that
_SLOW_BYTES = 200_000_000  # of a log without an index, which take long to read first
_NEVER = NODE_CHANNEL.rpartition("/")[0] + "/"  # announcements of nodes that no longer run


@dataclass(frozen=True, slots=True, kw_only=True)
class Choice:
    """The channels that are played, and their names."""

    topics: TopicChoice = field(default_factory=TopicChoice)
    names: NodeArguments = field(default_factory=NodeArguments)  # for namespace and remaps
    keeps_clock: bool = False  # True if /clock keeps its name in a namespace
    only_utf_8: bool = False  # True if the bus has no other channels


@dataclass(frozen=True, slots=True)
class Track:
    """A channel of the logs, and the topic on which it is played."""

    channel: str
    topic: str
    messages: int  # in the logs
    type: str = ""  # "" if unknown
    fingerprint: int | None = None  # of its first message
    is_latched: bool = False  # at some time


class Played(NamedTuple):
    """A message of a log."""

    time: int  # time of recording [ns since 1970]; after a step back in the log, later
    topic: str
    payload: bytes
    sender: str = ""  # the name of its sender; "" if unknown


class _ContinuousLog(LogFile):
    """A log whose events after a step back in time have later times, as if no time had passed."""

    def __init__(self, path: str | Path) -> None:
        self._steps: list[tuple[int, int]] = []  # offset, and what is added from there on [ns]
        self._parts = [(-sys.maxsize, 0)]  # first time of playing, and what is added [ns]
        super().__init__(path)

    def remove_steps(self) -> None:
        """Find the steps, and change the times of the events after them."""
        later, latest = 0, None
        for event in super().events():
            if latest is not None and abs(event.time + later - latest) > _STEP:
                later = self._later_from(event.time, latest)
                self._steps.append((event.start, later))
            time = event.time + later
            latest = time if latest is None else max(latest, time)
        self.index = replace(self.index, blocks=[])

    def events(self, start: int = 0, end: int | None = None) -> Iterator[Event]:
        """Yield the places of the events, with the times at which they are to be played."""
        found = super().events(start, end)
        if not self._steps:
            return found
        return (event._replace(time=event.time + self._later(event)) for event in found)

    def recorded_time(self, time: int) -> int:
        return time - self._parts[bisect_right(self._parts, time, key=itemgetter(0)) - 1][1]

    def _later_from(self, time: int, latest: int) -> int:
        """Return what to add to a time after a step: as in the part that it continues, if any."""
        fits = [one for one in self._parts[-_MOST_PARTS:] if time + one[1] >= latest - _STEP]
        if not fits:
            self._parts.append((latest, latest - time))
            return latest - time
        part = min(fits, key=itemgetter(1))
        del self._parts[self._parts.index(part) + 1 :]  # they were single messages
        return part[1]

    def _later(self, event: Event) -> int:
        place = bisect_right(self._steps, event.start, key=itemgetter(0))
        return self._steps[place - 1][1] if place else 0


class Playlist(AbstractContextManager["Playlist"]):
    """The messages of one or more logs, merged by their times.

    Where times go back by more than a second, the rest is played as if it came at once: its times
    are later than those of recording.

    Hidden channels, such as those of services, are played only if they are named. Nodes' recorded
    announcements never are.

    Raises:
        BusError: A file cannot be read, or is not a log.
        LcmtoolsError: A log is empty, or a named topic is missing.
        InvalidName: A topic's new name breaks the rules.
    """

    def __init__(
        self,
        paths: Sequence[str | Path],
        choice: Choice,
        notify: Callable[[str], None] = lambda _: None,
    ) -> None:
        self._nodes = GraphBuilder(is_log=True)
        self._logs: list[tuple[_ContinuousLog, Sequence[Block]]] = []
        self._latched: list[LatchedTopics] = []  # of each log
        try:
            for path in paths:
                log = _ContinuousLog(path)
                if log.size - log.index.end > _SLOW_BYTES:
                    notify(f"reading {path}; with an index (lcmtools bag reindex) this is instant")
                self._latched.append(LatchedTopics())
                for packet in log.announcements():
                    self._add_announcement(packet)
                blocks = list(log.blocks(self._add_announcement))
                if damage := log.damage(blocks):
                    notify(damage)
                if back := disorder(blocks):
                    far = f", by up to {span_text(back / NANOSECONDS)}" if back > _STEP else ""
                    notify(f"the times of {path} go back{far}; lcmtools bag sort sorts them")
                if back > _STEP:
                    log.remove_steps()
                    blocks = list(log.blocks())
                self._logs.append((log, blocks))
                provide_recorded_types(log.index.types.values())
            # The times of the first and the last message of the logs [ns since 1970].
            self.span = _span(self._logs)
            self.tracks = self._tracks(choice, notify)  # what is played, sorted by channel
        except BaseException:
            self.close()
            raise

    def __exit__(self, *_: object) -> None:
        """Close the files."""
        self.close()

    def close(self) -> None:
        """Close the files."""
        for log, _ in self._logs:
            log.close()

    def messages(
        self, start: int, end: int, only: Collection[str] | None = None
    ) -> Iterator[Played]:
        """Yield the messages from one time to another, both included [ns since 1970].

        ``only`` has the wanted topics; None for all.
        """
        tracks = (one for one in self.tracks if only is None or one.topic in only)
        topics = {track.channel: track.topic for track in tracks}
        parts = [_messages(log, blocks, (start, end), topics) for log, blocks in self._logs]
        return parts[0] if len(parts) == 1 else heapq.merge(*parts, key=lambda one: one.time)

    def played(self, start: int, end: int) -> Iterator[Played]:
        """Yield ``messages``, after those that were latched at the start, if it is within."""
        if start > self.span[0]:
            yield from (one._replace(time=start) for one in self.latched(start))
        yield from self.messages(start, end)

    def latched(self, time: int) -> list[Played]:
        """Return the messages before a time that were latched then, one of each sender."""
        topics = {track.channel: track.topic for track in self.tracks if track.is_latched}
        found: dict[tuple[str, Sender | None], Packet] = {}
        for (log, blocks), latched in zip(self._logs, self._latched, strict=True):
            there = latched.at(log.recorded_time(time)) & topics.keys()
            for one in log.latest(there, time, blocks):
                before = found.get((one.channel, one.sender))
                if before is None or before.time <= one.time:
                    found[one.channel, one.sender] = one
        in_order = sorted(found.values(), key=lambda one: one.time)
        return [Played(one.time, topics[one.channel], one.payload) for one in in_order]

    def senders(self) -> dict[str, set[str]]:
        """Return the names of each topic's senders, as far as they are known."""
        found: dict[str, set[str]] = {track.topic: set() for track in self.tracks}
        topics = {track.channel: track.topic for track in self.tracks}
        for log, blocks in self._logs:
            for block in blocks:
                for channel in block.channels.keys() & topics.keys():
                    numbers = (number for number, _ in block.channels[channel].senders)
                    known = (
                        log.senders[number].name for number in numbers if number in log.senders
                    )
                    found[topics[channel]].update(known)
        return found

    def untold(self) -> Iterator[str]:
        """Yield a sentence on each log that does not tell what was latched."""
        for (log, _), latched in zip(self._logs, self._latched, strict=True):
            if not latched.is_known:
                yield untold(log.path)

    def latest(self, topics: Collection[str], time: int, after: int = 0) -> list[Played]:
        """Return each topic's last message between ``after`` and ``time``, in order of time."""
        found: dict[str, Played] = {}
        for log, blocks in self._logs:
            wanted = {one.channel: one.topic for one in self.tracks if one.topic in topics}
            for block in sorted(blocks, key=lambda one: one.last_time, reverse=True):
                is_within = block.first_time <= time and block.last_time > after
                if not is_within or wanted.keys().isdisjoint(block.channels):
                    continue
                here = {name: wanted[name] for name in wanted.keys() & block.channels.keys()}
                for one in _messages(log, [block], (after + 1, time), here):
                    if one.topic not in found or one.time >= found[one.topic].time:
                        found[one.topic] = one
                wanted = {name: topic for name, topic in wanted.items() if topic not in found}
        return sorted(found.values(), key=lambda one: one.time)

    def recorded_time(self, time: int) -> int:
        """Return the time of recording in the first log for a time of playing."""
        return self._logs[0][0].recorded_time(time)

    def histogram(self, bins: int) -> list[int]:
        """Return the number of messages in each of ``bins`` equal parts of the logs' time."""
        parts = [histogram(log, blocks, self.span, bins) for log, blocks in self._logs]
        return [sum(one) for one in zip(*parts, strict=True)]

    def losses(self) -> list[int]:
        """Return the times at which the recorder found messages lost [ns since 1970]."""
        return [time for log, _ in self._logs for time, _, _ in log.loss_times()]

    def announced(self) -> GraphBuilder:
        """Return the announcements of all nodes in the logs."""
        return self._nodes

    def _add_announcement(self, packet: Packet) -> None:
        self._nodes.add(packet)
        self._latched[-1].add(packet)

    @cached_property
    def _counts(self) -> Mapping[str, tuple[int, int | None]]:
        """Return the number of messages and the fingerprint of each channel."""
        found: dict[str, tuple[int, int | None]] = {}
        for _, blocks in self._logs:
            for block in blocks:
                for channel, count in block.channels.items():
                    messages, number = found.get(channel, (0, count.fingerprint))
                    found[channel] = messages + count.messages, number
        return found

    def _tracks(self, choice: Choice, notify: Callable[[str], None]) -> tuple[Track, ...]:
        counts = self._counts
        names = [name for name in sorted(counts) if not name.startswith(_NEVER)]
        choice.topics.check(names)
        hidden = TopicChoice([word for word in choice.topics.wanted if is_hidden(word)])
        chosen = [
            name
            for name in names
            if choice.topics.has(name)
            and (not is_hidden(name) or (hidden.wanted and hidden.has(name)))
        ]
        if not chosen:
            paths = ", ".join(str(log.path) for log, _ in self._logs)
            raise LcmtoolsError(f"no messages of {paths} are left to play", "select other topics")
        moved = _moved(chosen, choice)
        for odd in [name for name in chosen if choice.only_utf_8 and not is_utf_8(moved[name])]:
            chosen.remove(odd)
            notify(f"{odd} is left out: this bus has no channel that is not UTF-8")
        types_of = self._nodes.types_of
        latched = frozenset[str]().union(*(one.ever() for one in self._latched))
        return tuple(
            replace(
                _track(channel, moved[channel], counts[channel], types_of(channel)),
                is_latched=channel in latched,
            )
            for channel in chosen
        )


def _span(logs: Sequence[tuple[_ContinuousLog, Sequence[Block]]]) -> tuple[int, int]:
    for log, blocks in logs:
        if not blocks:
            hint = "its first one is not complete" if log.size else "it is empty"
            raise LcmtoolsError(f"{log.path} has no messages", hint)
    return span_of([block for _, blocks in logs for block in blocks])


def _messages(
    log: LogFile, blocks: Sequence[Block], window: tuple[int, int], topics: Mapping[str, str]
) -> Iterator[Played]:
    start, end = window
    for block in blocks:
        if block.last_time < start or block.first_time > end:
            continue
        if topics.keys().isdisjoint(block.channels):
            continue
        for event, sender in log.of_block(block, block.start):
            topic = topics.get(event.channel)
            if topic is not None and start <= event.time <= end:
                payload = log.data[event.payload_start : event.end]
                yield Played(event.time, topic, payload, sender.name if sender else "")


def _moved(channels: Sequence[str], choice: Choice) -> Mapping[str, str]:
    """Return the topic of each channel: by a remap, else in the namespace."""
    said = choice.names
    namespace = resolve_namespace(said.namespace or "/")
    moved = {}
    for channel in channels:
        is_kept = namespace == "/" or (choice.keeps_clock and channel == CLOCK_TOPIC)
        below = f"{namespace}/{channel.lstrip('/')}"
        moved[channel] = channel if is_kept else below
    for source, target in said.remaps:
        found = [channel for channel in channels if channel in spellings(source)]
        if not found:
            TopicChoice([source]).check(channels)
        moved.update(dict.fromkeys(found, Resolver(namespace).resolve(target)))
    for topic in moved.values():
        check_length(topic)
    return moved


def _track(
    channel: str, topic: str, count: tuple[int, int | None], announced: Sequence[str]
) -> Track:
    messages, number = count
    known = [] if number is None else possible_types(number, channel, announced)
    return Track(channel, topic, messages, next(iter((*known, *announced)), ""), number)
