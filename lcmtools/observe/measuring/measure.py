"""Measuring topics over windows of messages: the loop that hz, bw and delay share.

Belongs here: when a report is due, and which is the last. Must not know the measured quantity.
"""

import math
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import groupby
from operator import itemgetter
from typing import Generic, TypeVar

from lcmtools.bus.tap import LONG_NAP
from lcmtools.clock import join_stamp
from lcmtools.errors import DecodeError, LcmtoolsError, NothingReceived, UnknownType
from lcmtools.graph.model import Graph
from lcmtools.messages.filter import Filter
from lcmtools.messages.layout import stamp_reader
from lcmtools.messages.message_time import FIRST_TIME, MessageTime, message_time
from lcmtools.messages.registry import message_class, type_name
from lcmtools.names import Resolver, has_wildcard
from lcmtools.observe.measuring.counters import Counters
from lcmtools.observe.measuring.rates import Window
from lcmtools.observe.reading.arrivals import PATIENCE, ArrivalStream, Batch, SelectedPacket
from lcmtools.observe.reading.decoding import Decoder, UnknownFingerprint
from lcmtools.observe.reading.find import GLOBAL, known_spelling
from lcmtools.observe.reading.losses import total
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.observe.reading.selection import (
    OneTopic,
    TopicPattern,
    select_topics,
    selected_topics,
)
from lcmtools.wire.packet import Packet

_JUMP = 0.1  # [s] that the clock is set by at once; corrections in use are smaller
_REPORT_PERIOD = 1.0  # [s]
_MOST_SIZES = 1000  # sizes of messages that are remembered
_LONGEST = 0.5  # [s] at most between two compared samples of counters
_ENOUGH = 4  # messages on each topic are enough to end sooner
_AWAKENING = 0.3  # [s] at most until publishers send a first message to a new listener
_TOPIC: Callable[[SelectedPacket], str] = itemgetter(0)

ItemT = TypeVar("ItemT")
FoundT = TypeVar("FoundT")
Notify = Callable[[str], None]


class TimeReader:
    """Reads times; if a message of equal type and size has been decoded, only that."""

    def __init__(self, decoder: Decoder) -> None:
        self._decoder = decoder
        self._readers: dict[tuple[str, bytes, int], Callable[[bytes], Sequence[int]]] = {}

    def read(self, packet: Packet) -> MessageTime | None:
        """Return the time of a message; None if its type has none.

        Raises:
            DecodeError: Its type is unknown, or it is malformed.
        """
        payload = packet.payload
        key = packet.channel, payload[:8], len(payload)
        if read := self._readers.get(key):
            stamped = join_stamp(*read(payload))
            return MessageTime("header.stamp", stamped, stamped)
        message = self._decoder.decode(packet)
        if (reader := stamp_reader(type(message))) and len(self._readers) < _MOST_SIZES:
            self._readers[key] = reader
        return message_time(message)


class Delays:
    """The delays of messages: from the times in them, such as their headers' stamps, to arrival.

    ``notify`` is called with a sentence once, if a stamp is not a time, and for each topic with
    times of another kind.
    """

    def __init__(self, decoder: Decoder, notify: Notify) -> None:
        self._decoder = decoder
        self._notify = notify
        self._told: set[str] = set()
        self._reader = TimeReader(decoder)

    def __call__(self, arrival: SelectedPacket) -> int | None:
        """Return the delay of a message [ns]; None if its stamp is no time, or one of another base.

        Raises:
            LcmtoolsError: Its type is unknown or has no header.
            DecodeError: It is malformed.
        """
        time = self.time(arrival)
        return None if time is None else arrival.time - time

    def time(self, arrival: SelectedPacket) -> int | None:
        """Return the time in a message [ns since 1970], as for its delay."""
        found, topic = self._time(arrival.packet), arrival.topic
        if not found.time:
            name = found.field.rpartition(".")[2]
            says = f"the {name} of a message on {topic} is {found.value}, which is not a time"
            self._tell_once("", says)
            return None
        if (found.time < FIRST_TIME) is not (arrival.time < FIRST_TIME):
            self._tell_once(f"base of {topic}", _other_base(topic, found.time, arrival.time))
            return None
        if str(found) != found.field:
            self._tell_once(topic, f"the delay of {topic} is measured by its {found}")
        return found.time

    def _tell_once(self, about: str, sentence: str) -> None:
        if about not in self._told:
            self._told.add(about)
            self._notify(sentence)

    def _time(self, packet: Packet) -> MessageTime:
        try:
            found = self._reader.read(packet)
        except UnknownFingerprint as error:
            raise LcmtoolsError(
                f"the type of the messages on {packet.channel} is not known: {error.what}",
                f"lcmtools echo {packet.channel} shows their bytes",
            ) from None
        if found is None:
            what = "has no header with a stamp, and no utime, timestamp or the like"
            name = type_name(self._decoder.message_class(packet))
            raise LcmtoolsError(
                f"{name}, published on {packet.channel}, {what}",
                "lcmtools msg find-field header lists the types that have one",
            )
        return found


def _other_base(topic: str, stamped: int, arrival: int) -> str:
    """Return why the delay from a stamp to an arrival [ns] has no meaning."""
    if stamped < FIRST_TIME:
        what = f"is {stamped / 1e9:.3f} s: since a start, or simulated without a /clock here"
        return f"the stamp of a message on {topic} {what}; such messages have no delay"
    what = f"is real time, while /clock is at {arrival / 1e9:.3f} s"
    return f"the stamp of a message on {topic} {what}; --wall-time measures its delay"


@dataclass(frozen=True, slots=True)
class ListenOptions:
    """The messages that a measurement counts, and its end."""

    timeout: float | None = None  # longest time without a message [s]; None for no limit
    count: int | None = None  # number of reports; None for no limit
    wall_time: bool = False  # use the system clock even if a simulator publishes /clock
    condition: Filter | None = None  # that messages must fulfil
    names: Resolver = GLOBAL  # namespace and remaps of the topics
    log_time: bool = True  # for a log, use the times of recording even if it has /clock


@dataclass(frozen=True, slots=True)
class MeasurementReport(Generic[FoundT]):
    """The values found, by topic; or the fact that simulated time went back."""

    found: Mapping[str, FoundT | None]
    is_reset: bool = False


class Measurement(Generic[ItemT, FoundT]):
    """A measurement of topics on a bus, or of a log, which is read at once by its own times.

    ``windows`` gets the window of each topic, as typed or, for a pattern, as it arrives; ``item``
    returns what a window needs of a message, or None if the message does not count. ``notify`` is
    called with a sentence for the user.

    Raises:
        ValueMismatch: The condition does not fit an announced type.
    """

    def __init__(
        self,
        monitor: BusMonitor,
        topics: Sequence[str],
        windows: defaultdict[str, Window[ItemT, FoundT]],
        item: Callable[[SelectedPacket], ItemT | None],
        options: ListenOptions,
        notify: Notify,
    ) -> None:
        self._monitor, self._windows, self._item = monitor, windows, item
        self._topics = list(dict.fromkeys(topics))
        self._options, self._notify = options, notify
        self._decoder = Decoder(monitor.types_of)
        self._has_notified = False
        self._silent = dict.fromkeys(self._topics)
        self._now = 0
        self._last_time: int | None = None  # [ns] of a log's latest arrival
        self._goes_back = False
        self._clock = _clock()
        monitor.discover()
        if monitor.tap:
            monitor.tap.longest_nap = LONG_NAP
        selections = [select_topics(one, options.names, with_path=False) for one in self._topics]
        self._patterns = {one.text for one in selections if isinstance(one, TopicPattern)}
        for topic in self._topics:
            if topic not in self._patterns:
                windows[topic]  # make it
        self._stream = ArrivalStream(
            monitor,
            selections,
            options.names,
            wall_time=options.wall_time or (options.log_time and not monitor.is_live),
            strict_time=True,
            keep=self._counts if options.condition else None,
        )
        self.is_simulated = self._stream.is_simulated  # the times are simulated
        # The channels that it listens to now; none for a log.
        self.channels = self._channels(selections) if monitor.is_live else []

    def reports(self) -> Iterator[MeasurementReport[FoundT]]:
        """Yield a report once a second, and a last one on Ctrl-C or at a log's end.

        Raises:
            KeyboardInterrupt: Ctrl-C, after the last report.
            NothingReceived: No message came within the timeout.
            LcmtoolsError: The log has no message on the topics.
            ValueMismatch: The condition does not fit a message.
        """
        try:
            yield from self._until_count()
        except (KeyboardInterrupt, EOFError) as end:
            last = self._report()
            if any(last.found.values()):
                yield last
            if isinstance(end, KeyboardInterrupt):
                raise
            self._notify_missing()

    def _until_count(self) -> Iterator[MeasurementReport[FoundT]]:
        is_live, timeout = self._monitor.is_live, self._options.timeout
        last = start = time.monotonic()
        due = start + _REPORT_PERIOD if is_live else math.inf
        reports = 0
        while reports != self._options.count:
            give_up = last + timeout if is_live and timeout is not None else math.inf
            wait = min(due, give_up) - time.monotonic()
            batch = self._stream.receive(min(_REPORT_PERIOD, max(0.0, wait)))
            if self._has_jumped():
                batch = batch._replace(arrivals=[], is_reset=True)
            if batch.is_reset:
                yield MeasurementReport({}, is_reset=True)
            counted, now = self._feed(batch), time.monotonic()
            if counted:
                last = now
            elif now >= give_up:
                what = "nothing that counts" if batch.arrivals else "nothing"
                missing = f"{what} {self._which()} within {timeout:g} s"
                raise NothingReceived(missing, self._stream.situation())
            if now >= due:
                report = self._report()
                yield report
                reports += any(report.found.values())
                due += _REPORT_PERIOD
                if PATIENCE <= now - start < PATIENCE + _REPORT_PERIOD:
                    self._notify_silent()

    def _has_jumped(self) -> bool:
        """Return whether the computer's clock, by which messages are timed, was set meanwhile."""
        if not self._monitor.is_live or self.is_simulated:
            return False
        before, self._clock = self._clock, _clock()
        (least, most), (was_least, was_most) = self._clock, before
        return max(least - was_most, was_least - most) > _JUMP

    def _report(self) -> MeasurementReport[FoundT]:
        return MeasurementReport(
            {topic: window.next_result(self._now) for topic, window in self._windows.items()}
        )

    def _feed(self, batch: Batch) -> int:
        """Add arrivals to the windows; return the number of those that count."""
        before = sum(window.total for window in self._windows.values())
        self._now = batch.now if self._monitor.is_live else 0  # a log has no current time
        if not self._monitor.is_live:
            self._check_order(batch)
        if batch.is_reset:
            for window in self._windows.values():
                window.clear()
        for topic, arrivals in groupby(batch.arrivals, self._topic if self._patterns else _TOPIC):
            items = [item for item in map(self._item, arrivals) if item is not None]
            self._windows[topic].add(*items)
        if self._silent:
            for topic in {arrival.topic for arrival in batch.arrivals}:
                self._silent.pop(topic, None)
        return sum(window.total for window in self._windows.values()) - before

    def _topic(self, arrival: SelectedPacket) -> str:
        return arrival.packet.channel if arrival.topic in self._patterns else arrival.topic

    def _check_order(self, batch: Batch) -> None:
        for arrival in batch.arrivals:
            if self._last_time is not None and arrival.time < self._last_time:
                self._goes_back = True
            self._last_time = arrival.time

    def _counts(self, packet: Packet) -> bool:
        """Return whether a message meets the condition; one that cannot be decoded does not."""
        try:
            message = self._decoder.decode(packet)
        except DecodeError as reason:
            if not self._has_notified:
                self._has_notified = True
                self._notify(f"a message on {packet.channel} has no known fields: {reason}")
            return False
        return self._options.condition is None or self._options.condition.matches(message)

    def _channels(self, selections: Iterable[OneTopic | TopicPattern]) -> list[str]:
        """Return the channels of topics; the condition is checked for each with one known type."""
        graph, names = self._stream.graph, self._options.names
        found: list[str] = []
        for one in selections:
            if isinstance(one, TopicPattern):
                found += one.channels()
            else:
                known = known_spelling(graph, one.text, names)
                found.append(known or names.spellings(one.text)[-1])
        for types in (graph.topic(channel).types for channel in found):
            if self._options.condition and len(types) == 1:
                with suppress(UnknownType):
                    self._options.condition.check(message_class(types[0]))
        return found

    def _which(self) -> str:
        condition = self._options.condition
        return f"came on {', '.join(self._topics)}{f', with {condition},' if condition else ''}"

    @property
    def _with_condition(self) -> str:
        return f" with {self._options.condition}" if self._options.condition else ""

    def _notify_silent(self) -> None:
        """Say on which topics nothing has come, and which topic was probably meant."""
        for topic in self._silent:
            situation = self._stream.situation(topic)
            self._notify(f"no message on {topic}{self._with_condition} yet; {situation}")

    def _notify_missing(self) -> None:
        """Say the same for a log, and whether its times make the measurement useless."""
        if len(self._silent) == len(self._topics):
            raise self._missing(self._topics)
        if self._goes_back:
            self._notify("the times of the log go back; lcmtools bag sort sorts them")
        for topic in self._silent:
            self._notify(str(self._missing([topic])))

    def _missing(self, topics: Sequence[str]) -> LcmtoolsError:
        unheard = [topic for topic in topics if topic in self._stream.silent()]
        hint = self._stream.near(unheard[0]) if unheard else ""
        said = f"the log has no message on {', '.join(topics)}{self._with_condition}"
        return LcmtoolsError(said, hint)


def _clock() -> tuple[float, float]:
    """Return the bounds of the difference between the computer's clock and a monotonic one [s]."""
    before, now, after = time.monotonic(), time.time(), time.monotonic()
    return now - after, now - before


def lossy_senders(
    monitor: BusMonitor, topics: Sequence[str], names: Resolver = GLOBAL
) -> Iterator[str]:
    """Return a sentence for each sender of the topics whose messages did not all arrive."""
    graph, known = monitor.graph(), monitor.losses()
    for spelling in (spelling for topic in topics for spelling in names.spellings(topic)):
        for seen in graph.topic(spelling).traffic:
            loss = total([seen.sender], known)
            if loss and loss.lost:
                what = f"of {seen.sender}, which sends {spelling}, {loss} messages did not"
                yield f"{what} arrive here; lcmtools wtf shows more"


def watch_counters(
    monitor: BusMonitor,
    words: Sequence[str],
    wait: float | None,
    names: Resolver = GLOBAL,
    *,
    with_messages: bool = False,
) -> tuple[Graph, Counters]:
    """Return a bus's graph, and the counters of the endpoints of topics, or patterns, as typed.

    It counts for ``wait`` [s], or for as long as needed, at most half a second: ``with_messages``
    also if the rates are announced but no message has come.

    Raises:
        LcmtoolsError: A topic is not on the bus; the hint has the topic that was probably meant.
    """
    named = [word for word in words if not has_wildcard(word)]
    monitor.listen_to([spelling for name in named for spelling in names.spellings(name)])
    graph = monitor.settle()
    topics = selected_topics(graph, words, names)
    if any(map(has_wildcard, words)):
        monitor.listen_to([topic.name for topic in topics])
    publishers = [node for topic in topics for node, _ in topic.publishers if not node.stale]
    if monitor.is_log or not (publishers or any(topic.traffic for topic in topics)):
        return graph, Counters(graph, graph, monitor.losses())
    ends = [one for topic in topics for one in (*topic.publishers, *topic.subscribers)]
    announced = Counters(graph, graph, monitor.losses())
    is_foreign = any(topic.foreign for topic in topics)
    is_known = not is_foreign and all(announced.rate(node, end) for node, end in ends)
    is_seen = all(topic.traffic for topic in topics) or not with_messages
    if wait is None and is_known and is_seen:
        return graph, announced
    channels = [topic.name for topic in topics]
    # some nodes publish only for a listener: their first messages may take a moment
    came = _listen(monitor, channels, _AWAKENING, 1)
    before = monitor.settle(foreign=False)
    if wait is not None:
        _listen(monitor, channels, wait, math.inf)
    elif came:
        _listen(monitor, channels, _LONGEST, _ENOUGH)
    after = monitor.settle(foreign=False)
    return after, Counters(before, after, monitor.losses())


def _listen(monitor: BusMonitor, channels: Sequence[str], longest: float, enough: float) -> bool:
    """Count messages until there are enough on each channel; return True if any came."""
    counts = dict.fromkeys(channels, 0)
    deadline = time.monotonic() + longest
    while (left := deadline - time.monotonic()) > 0 and min(counts.values()) < enough:
        for packet in monitor.receive(left):
            if packet.channel in counts:
                counts[packet.channel] += 1
    return any(counts.values())
