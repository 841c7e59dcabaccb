"""Measuring topics over windows of messages: the loop that hz, bw and delay share.

Belongs here: when a report is due, and which is the last. Must not know what is measured.
"""

import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from lcmtools.errors import DecodeError, LcmtoolsError, NothingReceived, UnknownType
from lcmtools.messages.fields import stamp
from lcmtools.messages.filter import Filter
from lcmtools.messages.registry import message_class, type_name
from lcmtools.names import Resolver
from lcmtools.observe.arrivals import PATIENCE, ArrivalStream, Batch, SelectedPacket
from lcmtools.observe.decoding import Decoder, UnknownFingerprint
from lcmtools.observe.find import GLOBAL, ask_nodes, known_spelling
from lcmtools.observe.monitor import BusMonitor
from lcmtools.observe.rates import BandwidthWindow, DelayWindow, RateWindow
from lcmtools.observe.selection import OneTopic
from lcmtools.wire.packet import Packet

_REPORT_PERIOD = 1.0  # [s]

FoundT_co = TypeVar("FoundT_co", covariant=True)
FoundT = TypeVar("FoundT")


class Meter(Protocol[FoundT_co]):
    """A measurement of one topic."""

    def feed(self, arrival: SelectedPacket) -> None:
        """Take a message into account."""
        ...

    def take(self, now: int) -> FoundT_co | None:
        """Return what was found at a time [ns]; None when there is nothing new to say."""
        ...

    def clear(self) -> None:
        """Forget everything: time begins again."""
        ...


class RateMeter(RateWindow):
    """The rate of a topic."""

    def feed(self, arrival: SelectedPacket) -> None:
        """Take a message into account."""
        self.add(arrival.time)


class BandwidthMeter(BandwidthWindow):
    """The bandwidth of a topic."""

    def feed(self, arrival: SelectedPacket) -> None:
        """Take a message into account."""
        self.add(arrival.time, arrival.packet.size)


class DelayMeter(DelayWindow):
    """The delay of a topic: from the stamps in its messages' headers to their arrival.

    Args:
        size: How many arrivals are kept; at least 1.
        decoder: Decodes the messages.
        notify: Called with a sentence about stamps that are no times, once.
    """

    def __init__(self, size: int, decoder: Decoder, notify: Callable[[str], None]) -> None:
        super().__init__(size)
        self._decoder = decoder
        self._notify = notify
        self._has_told = False

    def feed(self, arrival: SelectedPacket) -> None:
        """Take a message into account.

        Raises:
            LcmtoolsError: Its type is unknown or has no header.
            DecodeError: It is malformed.
        """
        stamped = self._stamp(arrival.packet)
        if stamped:
            self.add(arrival.time, stamped)
        elif not self._has_told:
            self._has_told = True
            self._notify(f"the stamp of a message on {arrival.topic} is 0, which is no time")

    def _stamp(self, packet: Packet) -> int:
        try:
            message = self._decoder.decode(packet)
        except UnknownFingerprint:
            raise LcmtoolsError(
                f"the type of the messages on {packet.channel} is not known",
                f"lcmtools echo {packet.channel} shows their bytes",
            ) from None
        stamped = stamp(message)
        if stamped is None:
            raise LcmtoolsError(
                f"{type_name(message)}, which comes on {packet.channel}, has no header with a"
                " stamp",
                "lcmtools msg find-field header lists the types that have one",
            )
        return stamped


@dataclass(frozen=True, slots=True)
class ListenOptions:
    """Which messages count, and for how long.

    Attributes:
        timeout: The longest time without a message [s]; None for without end.
        count: The number of reports that end it; None for never.
        wall_time: Go by the computer's clock where a simulator keeps the time too.
        condition: Only messages for which it is true count; None for all.
        names: The namespace and the remaps that topics are read by.
    """

    timeout: float | None = None
    count: int | None = None
    wall_time: bool = False
    condition: Filter | None = None
    names: Resolver = GLOBAL


@dataclass(frozen=True, slots=True)
class Report(Generic[FoundT]):
    """The values found, by topic; or the fact that simulated time went back."""

    found: Mapping[str, FoundT | None]
    is_reset: bool = False


class Measurement(Generic[FoundT]):
    """A measurement of topics on a bus; of a log, read at once, by its own times.

    Args:
        monitor: The bus or the log.
        meters: A meter for each topic, as typed.
        options: Which messages count, and for how long.
        notify: Called with a sentence for the person.

    Attributes:
        channels: The channels that are listened to, one for each topic; none on a log.
        is_simulated: Simulated time is gone by.

    Raises:
        ValueMismatch: The condition does not fit a type that is announced.
    """

    def __init__(
        self,
        monitor: BusMonitor,
        meters: Mapping[str, Meter[FoundT]],
        options: ListenOptions,
        notify: Callable[[str], None],
    ) -> None:
        self._monitor, self._meters, self._options = monitor, meters, options
        self._notify = notify
        self._decoder = Decoder(monitor.types_of)
        self._has_told = False
        self._silent = dict.fromkeys(meters)
        self._now = 0
        ask_nodes(monitor)
        self._stream = ArrivalStream(
            monitor,
            [OneTopic(topic, options.names, with_path=False) for topic in meters],
            options.names,
            wall_time=options.wall_time or not monitor.is_live,
            strict_time=True,
            keep=self._counts if options.condition else None,
        )
        self.is_simulated = self._stream.is_simulated
        self.channels = [self._channel(topic) for topic in meters] if monitor.is_live else []

    def reports(self) -> Iterator[Report[FoundT]]:
        """Return a report once a second, and a last one when Ctrl-C or a log's end ends it.

        Raises:
            KeyboardInterrupt: Ctrl-C, after the last report.
            NothingReceived: No message came for as long as the timeout is.
            LcmtoolsError: Nothing in a log is on the topics.
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
            self._tell_missing()

    def _until_count(self) -> Iterator[Report[FoundT]]:
        is_live, timeout = self._monitor.is_live, self._options.timeout
        last = start = time.monotonic()
        due = start + _REPORT_PERIOD if is_live else math.inf
        reports = 0
        while reports != self._options.count:
            give_up = last + timeout if is_live and timeout is not None else math.inf
            wait = min(due, give_up) - time.monotonic()
            batch = self._stream.receive(min(_REPORT_PERIOD, max(0.0, wait)))
            if batch.is_reset:
                yield Report({}, is_reset=True)
            self._feed(batch)
            now = time.monotonic()
            if batch.arrivals:
                last = now
            elif now >= give_up:
                raise NothingReceived(f"nothing {self._which()} within {timeout:g} s")
            if now >= due:
                report = self._report()
                yield report
                reports += any(report.found.values())
                due += _REPORT_PERIOD
                if PATIENCE <= now - start < PATIENCE + _REPORT_PERIOD:
                    self._tell_silent()

    def _report(self) -> Report[FoundT]:
        return Report({topic: meter.take(self._now) for topic, meter in self._meters.items()})

    def _feed(self, batch: Batch) -> None:
        self._now = batch.now if self._monitor.is_live else 0  # a log has no now
        if batch.is_reset:
            for meter in self._meters.values():
                meter.clear()
        for arrival in batch.arrivals:
            self._meters[arrival.topic].feed(arrival)
        if self._silent:
            for topic in {arrival.topic for arrival in batch.arrivals}:
                self._silent.pop(topic, None)

    def _counts(self, packet: Packet) -> bool:
        """Return whether a message meets the condition; one that cannot be decoded does not."""
        try:
            message = self._decoder.decode(packet)
        except DecodeError as reason:
            if not self._has_told:
                self._has_told = True
                self._notify(f"a message on {packet.channel} has no known fields: {reason}")
            return False
        return self._options.condition is None or self._options.condition.matches(message)

    def _channel(self, topic: str) -> str:
        """The channel of a topic, for which the condition is checked if its type is announced."""
        graph, names = self._stream.graph, self._options.names
        channel = known_spelling(graph, topic, names) or names.spellings(topic)[-1]
        types = graph.topic(channel).types
        if self._options.condition and len(types) == 1:
            with suppress(UnknownType):
                self._options.condition.check(message_class(types[0]))
        return channel

    def _which(self) -> str:
        condition = self._options.condition
        return f"came on {', '.join(self._meters)}{f', with {condition},' if condition else ''}"

    def _tell_silent(self) -> None:
        """Say on which topics nothing has come, and what may have been meant."""
        condition = f" with {self._options.condition}" if self._options.condition else ""
        for topic in self._silent:
            self._notify(f"no message on {topic}{condition} yet; {self._stream.situation(topic)}")

    def _tell_missing(self) -> None:
        """Say the same of a log."""
        if len(self._silent) == len(self._meters):
            topics = ", ".join(self._meters)
            hint = self._stream.near(next(iter(self._meters)))
            raise LcmtoolsError(f"the log has no message on {topics}", hint)
        for topic in self._silent:
            self._notify(f"the log has no message on {topic}; {self._stream.near(topic)}")


def lossy_senders(
    monitor: BusMonitor, topics: Sequence[str], names: Resolver = GLOBAL
) -> Iterator[str]:
    """Return a sentence for each sender of the topics of which messages did not arrive."""
    from lcmtools.observe.losses import losses, total

    graph, known = monitor.graph(), losses(monitor.numbered)
    for topic in topics:
        for spelling in names.spellings(topic):
            for seen in graph.topic(spelling).traffic:
                loss = total([seen.sender], known)
                if loss and loss.lost:
                    what = f"of {seen.sender}, which sends {spelling}, {loss} messages did not"
                    yield f"{what} arrive here; lcmtools wtf looks closer"
