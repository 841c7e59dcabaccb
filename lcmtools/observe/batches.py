"""Pulling the messages of some topics and saying when to report: what hz, bw and delay share."""

import math
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

import click

from lcmtools.cli.output import talk
from lcmtools.errors import DecodeError, LcmtoolsError, NothingReceived, UnknownType
from lcmtools.graph.builder import GraphBuilder
from lcmtools.graph.model import Graph
from lcmtools.messages.filter import Filter
from lcmtools.messages.registry import message_class
from lcmtools.names import Resolver
from lcmtools.observe.arrival import CLOCK, Arrival, ArrivalClock, is_simulated
from lcmtools.observe.decoding import Decoder
from lcmtools.observe.find import GLOBAL, ask_nodes, known_spelling, near_topic
from lcmtools.observe.log_file import read_log
from lcmtools.observe.stream import situation
from lcmtools.wire.packet import Packet

if TYPE_CHECKING:
    from lcmtools.observe.monitor import BusMonitor

_REPORT_PERIOD = 1.0  # [s]
_PATIENCE = 2.0  # [s] without a message before the person is told what is on the bus


@dataclass(frozen=True, slots=True)
class ListenOptions:
    """What the command line says of listening.

    Attributes:
        timeout: How long to wait for a message [s]; None for without end.
        count: After how many reports to end; None for never.
        wall_time: Go by the computer's clock where a simulator keeps the time too.
        condition: Only messages for which it is true count; None for all.
        names: The namespace and the remaps of topics.
    """

    timeout: float | None = None
    count: int | None = None
    wall_time: bool = False
    condition: Filter | None = None
    names: Resolver = GLOBAL


@dataclass(frozen=True, slots=True)
class Batch:
    """What came in a moment.

    Attributes:
        arrivals: Messages of the topics.
        now: The time by the clock that the arrivals go by [ns]; 0 where nothing keeps it.
        is_due: It is time to report.
        is_last: A log has ended.
        is_reset: Simulated time went back: what came before is of another time.
    """

    arrivals: tuple[Arrival, ...]
    now: int
    is_due: bool = False
    is_last: bool = False
    is_reset: bool = False


def batches(monitor: "BusMonitor", topics: Sequence[str], how: ListenOptions) -> Iterator[Batch]:
    """Listen to topics; a report is due once a second. A log is read at once, by its own times.

    Raises:
        NothingReceived: No message came for as long as the timeout is.
        LcmtoolsError: Nothing in a log is on the topics.
        ValueMismatch: The condition does not fit a message.
    """
    sorter = _Sorter(monitor, topics, how)
    yield from sorter.log_turns() if monitor.url.provider == "file" else sorter.live_turns()


class _Sorter:
    """Tells whose a packet is, and whether it counts."""

    def __init__(self, monitor: "BusMonitor", topics: Sequence[str], how: ListenOptions) -> None:
        self._monitor = monitor
        self._how = how
        self._decoder = Decoder(monitor.types_of)
        self._clock = ArrivalClock(is_simulated=False)
        self._spellings = {topic: set(self._how.names.spellings(topic)) for topic in topics}
        self._topics: dict[str, list[str]] = {}
        self._silent = set(topics)
        self._has_told = False

    def live_turns(self) -> Iterator[Batch]:
        """Turns from a bus, without end."""
        self._subscribe()
        last = start = time.monotonic()
        report = start + _REPORT_PERIOD
        while True:
            give_up = math.inf if self._how.timeout is None else last + self._how.timeout
            left = min(report, give_up) - time.monotonic()
            turn = self._turn(self._monitor.receive(max(0.0, left)))
            now = time.monotonic()
            if turn.arrivals:
                last = now
            elif now >= give_up:
                raise NothingReceived(f"nothing {self._which()} within {self._how.timeout:g} s")
            yield Batch(turn.arrivals, turn.now, now >= report, is_reset=turn.is_reset)
            if now >= report:
                report += _REPORT_PERIOD
                if _PATIENCE <= now - start < _PATIENCE + _REPORT_PERIOD:
                    self._tell_silent()

    def log_turns(self) -> Iterator[Batch]:
        """Turns from a log, to its end."""
        builder = GraphBuilder()
        for packet in read_log(self._monitor.url):
            builder.hear(packet)
            yield self._turn([packet])
        yield Batch((), 0, is_due=True, is_last=True)
        self._tell_missing(builder.snapshot(0))

    def _turn(self, packets: Sequence[Packet]) -> Batch:
        arrivals: list[Arrival] = []
        is_reset = False
        for packet in packets:
            if self._clock.hear(packet):
                arrivals.clear()
                is_reset = True
            when = self._clock.time(packet)
            if when is not None:
                arrivals += [Arrival(topic, packet, when) for topic in self._topics_of(packet)]
        if self._silent:
            self._silent.difference_update(arrival.topic for arrival in arrivals)
        return Batch(tuple(arrivals), self._clock.now or time.time_ns(), is_reset=is_reset)

    def _topics_of(self, packet: Packet) -> list[str]:
        """The topics, as typed, that a packet counts for."""
        found = self._topics.get(packet.channel)
        if found is None:
            found = [name for name, them in self._spellings.items() if packet.channel in them]
            self._topics[packet.channel] = found
        return found if found and self._counts(packet) else []

    def _counts(self, packet: Packet) -> bool:
        """Whether a message meets the condition; one that cannot be read does not."""
        if self._how.condition is None:
            return True
        try:
            message = self._decoder.decode(packet)
        except DecodeError as reason:
            if not self._has_told:
                self._has_told = True
                talk(f"{_command()}: a message on {packet.channel} has no known fields: {reason}")
            return False
        return self._how.condition.matches(message)

    def _subscribe(self) -> None:
        graph = ask_nodes(self._monitor)
        self._clock.is_simulated = not self._how.wall_time and is_simulated(graph)
        listened = [name for names in self._spellings.values() for name in names]
        # A simulator tells the time seldom where nobody says that he listens to it.
        self._monitor.listen_to([*listened, CLOCK] if self._clock.is_simulated else listened)
        for topic in self._spellings:
            names = self._how.names
            spelling = known_spelling(graph, topic, names) or names.spellings(topic)[-1]
            self._check(graph, spelling)
            talk(f"subscribed to [{spelling}]")
        if self._clock.is_simulated:
            talk(f"{_command()}: times are simulated, as {CLOCK} says; --wall-time for real ones")

    def _check(self, graph: Graph, spelling: str) -> None:
        """Find what the condition cannot mean before a message has come."""
        types = graph.topic(spelling).types
        if self._how.condition and len(types) == 1:
            with suppress(UnknownType):
                self._how.condition.check(message_class(types[0]))

    def _which(self) -> str:
        """What is waited for."""
        condition = f", with {self._how.condition}," if self._how.condition else ""
        return f"came on {', '.join(self._spellings)}{condition}"

    def _tell_silent(self) -> None:
        """Say on which topics nothing has come, and what may have been meant."""
        condition = f" with {self._how.condition}" if self._how.condition else ""
        for topic in (topic for topic in self._spellings if topic in self._silent):
            hint = situation(self._monitor.graph(), topic, self._how.names)
            talk(f"{_command()}: no message on {topic}{condition} yet; {hint}")

    def _tell_missing(self, graph: Graph) -> None:
        """The same of a log."""
        if len(self._silent) == len(self._spellings):
            topics = ", ".join(self._spellings)
            hint = near_topic(graph, next(iter(self._spellings)), self._how.names)
            raise LcmtoolsError(f"the log has no message on {topics}", hint)
        for topic in (topic for topic in self._spellings if topic in self._silent):
            hint = near_topic(graph, topic, self._how.names)
            talk(f"{_command()}: the log has no message on {topic}; {hint}")


def _command() -> str:
    return click.get_current_context().command_path
