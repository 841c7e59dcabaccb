"""The merged stream of arrivals on the selected topics, from a bus or a log, and its clock."""

import time
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple, TypeVar

from lcmtools.bounded import BoundedDict
from lcmtools.clock import CLOCK_TOPIC, join_stamp
from lcmtools.errors import DecodeError, LcmtoolsError, NothingReceived
from lcmtools.graph.builder import MOST_FLOWS
from lcmtools.graph.model import Graph
from lcmtools.messages.codec import decode
from lcmtools.messages.path import Path
from lcmtools.names import Resolver, is_hidden
from lcmtools.observe.reading.find import GLOBAL, known_spelling, near_topic
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.observe.reading.selection import OneTopic, TopicPattern
from lcmtools.observe.simulators import has_simulated_time, pause_text
from lcmtools.wire.packet import Packet

TOGETHER = 8  # messages that are shown at once, if they arrived together
PATIENCE = 2.0  # [s] without a message before the user is told what is on the bus
_LOOK_PERIOD = 0.5  # [s] between searches for topics that a pattern matches
_MOST_NAMED = 8  # topics in one line
_WAIT = 0.2  # [s] at most between two checks of a timeout
_new = tuple.__new__  # creates a named tuple in half the time


class SelectedPacket(NamedTuple):
    """A packet on a selected topic."""

    topic: str  # the selection, as it was typed
    packet: Packet
    time: int  # of its arrival, by the stream's clock [ns]
    path: Path = Path()  # of the field after the topic's name


class Batch(NamedTuple):
    """The selected ones of the packets that arrived together."""

    arrivals: Sequence[SelectedPacket]
    now: int  # by the stream's clock [ns]
    is_reset: bool = False  # simulated time went back: earlier times no longer compare


class ArrivalClock:
    """The clock of arrivals: the system clock, or simulated time from ``/clock``."""

    def __init__(self, *, is_simulated: bool) -> None:
        self.is_simulated = is_simulated
        self.now: int | None = None  # simulated time [ns]; None before one came on ``/clock``

    def update(self, packet: Packet) -> bool:
        """Set the time by a message on ``/clock``; True if simulated time goes back."""
        if not self.is_simulated or packet.channel != CLOCK_TOPIC:
            return False
        from lcmtools.types.rosgraph_msgs import Clock

        try:
            stamp = decode(Clock, packet.payload).clock
        except DecodeError:
            return False  # the message has another type
        before, self.now = self.now, join_stamp(stamp.sec, stamp.nsec)
        return before is not None and self.now < before

    def time(self, packet: Packet) -> int | None:
        """Return the time of an arrival [ns]; None while simulated time is not known."""
        return self.now if self.is_simulated else packet.time


class ArrivalStream:
    """The packets of some topics, as they come; ``graph`` is as of the last update.

    With ``strict_time``, packets that arrive before the simulated time is known are left out; in a
    log it is known from the first message on /clock. With ``wall_time``, times are the system
    clock's even if a simulator publishes /clock. Only packets for which ``keep`` is true count.

    Raises:
        UsageError: The text after a topic's name is not a field path.
    """

    def __init__(
        self,
        monitor: BusMonitor,
        selections: Sequence[OneTopic | TopicPattern],
        names: Resolver = GLOBAL,
        *,
        wall_time: bool = False,
        strict_time: bool = False,
        keep: Callable[[Packet], bool] | None = None,
    ) -> None:
        self._monitor, self._selections, self._names = monitor, selections, names
        self._wall_time, self._strict_time, self._keep = wall_time, strict_time, keep
        self._routes = BoundedDict[str, list[tuple[str, Path]]](MOST_FLOWS)
        self._known = BoundedDict[str, bool](MOST_FLOWS)
        self._heard: set[str] = set()
        self._is_fixed = all(isinstance(one, OneTopic) and one.is_fixed for one in selections)
        self._announced: list[str] = []
        self._next_look = 0.0
        self._clock = ArrivalClock(is_simulated=False)
        self.graph = Graph()
        self._update_graph()

    @property
    def is_simulated(self) -> bool:
        """True if the times are simulated."""
        return self._clock.is_simulated

    @property
    def text(self) -> str:
        """The selected topics, for messages to the user."""
        return ", ".join(one.text for one in self._selections)

    def announced(self) -> list[tuple[tuple[str, ...], Path]]:
        """Return the types that nodes announce for each named topic, and the path after it."""
        named = [one for one in self._selections if isinstance(one, OneTopic)]
        spellings = [known_spelling(self.graph, one.text, self._names) for one in named]
        return [
            (self.graph.topic(spelling).types if spelling else (), one.path)
            for one, spelling in zip(named, spellings, strict=True)
        ]

    def receive(self, timeout: float) -> Batch:
        """Return what arrives, waiting up to ``timeout`` [s] for the first packet.

        Raises:
            EOFError: The log has ended.
        """
        packets = self._monitor.receive(timeout)
        if not self._is_fixed:
            self._update_graph_if_due(packets)
        self._detect_clock(packets)
        arrivals: list[SelectedPacket] = []
        is_reset, is_simulated = False, self._clock.is_simulated
        routes_of, keep = self._routes.use, self._keep
        for packet in packets:
            if is_simulated and self._clock.update(packet):
                is_reset = True
                arrivals.clear()
            routes = routes_of(packet[0])
            if routes is None:
                routes = self._routes[packet.channel] = self._routes_of(packet.channel)
            if routes and (keep is None or keep(packet)):
                when = self._simulated_time(packet) if is_simulated else packet[2]
                if when or not is_simulated:  # 0 is a valid time in a log
                    for one, path in routes:
                        arrivals.append(_new(SelectedPacket, (one, packet, when, path)))
        return Batch(arrivals, self._clock.now or time.time_ns(), is_reset)

    def _simulated_time(self, packet: Packet) -> int:
        return self._clock.time(packet) or (0 if self._strict_time else packet.time)

    def situation(self, topic: str = "") -> str:
        """Return the publishers of a topic; if none, a likely intended topic or what the bus has.

        ``topic`` is as typed; "" for the first published one, else the first.
        """
        graph = self._monitor.graph()
        if not topic:
            known = [channel for one in self._selections for channel in one.channels()]
            published = [channel for channel in known if graph.topic(channel).publishers]
            topic = published[0] if published else self._selections[0].text
        spelling = known_spelling(graph, topic, self._names)
        if spelling is None:
            near = near_topic(graph.topic_names(), topic, self._names)
            if near.startswith("did you mean"):
                return near
        elif publishers := [node.name for node, _ in graph.topic(spelling).publishers]:
            found = f"it is published by {', '.join(publishers)}"
            return "; ".join(filter(None, [found, pause_text(graph)]))
        seen = [name for name in graph.topic_names() if not is_hidden(name)]
        return f"on the bus: {', '.join(seen[:_MOST_NAMED])}" if seen else "no topic is on the bus"

    def contents(self) -> str:
        """Return the topics of a log that has been read, for messages to the user."""
        seen = self._recorded()
        return f"it has {', '.join(seen[:_MOST_NAMED])}" if seen else "there are no messages in it"

    def _recorded(self) -> list[str]:
        """The topics of a log that have messages in it, rather than only announcements."""
        graph = self._monitor.graph()
        return [name for name in graph.topic_names() if graph.topic(name).traffic]

    def near(self, topic: str) -> str:
        """Return the topic of a log that was probably meant, or the topics that the log has."""
        hint = near_topic(self._recorded(), topic, self._names)
        return hint if hint.startswith("did you mean") else self.contents()

    def silent(self) -> list[str]:
        """Return the selected topics on which nothing has come."""
        return [one.text for one in self._selections if one.text not in self._heard]

    def _routes_of(self, channel: str) -> list[tuple[str, Path]]:
        """The selections that a channel belongs to; several with one field path count as one."""
        found: dict[Path | str, tuple[str, Path]] = {}
        for one in self._selections:
            path = one.path_on(channel)
            if path is not None:
                self._heard.add(one.text)
                found.setdefault(one.text if self._is_fixed else path, (one.text, path))
        return list(found.values())

    def _detect_clock(self, packets: Sequence[Packet]) -> None:
        if self._strict_time and not (self._wall_time or self._monitor.is_live):
            self._clock.is_simulated |= any(packet.channel == CLOCK_TOPIC for packet in packets)

    def _update_graph_if_due(self, packets: Sequence[Packet]) -> None:
        new = {packet.channel for packet in packets if packet.channel not in self._known}
        for channel in new:
            self._known[channel] = True
        # an update takes longer the more channels there are, so it is not done for each new one
        is_told = CLOCK_TOPIC in new or any(one.is_told_by(new) for one in self._selections)
        if is_told or time.monotonic() >= self._next_look:
            self._update_graph()

    def _update_graph(self) -> None:
        """Tell topics from paths, match patterns, and announce that it listens to the channels."""
        self._next_look = time.monotonic() + _LOOK_PERIOD
        self.graph = graph = self._monitor.graph()
        self._routes.clear()
        self._clock.is_simulated = not self._wall_time and has_simulated_time(graph)
        for one in self._selections:
            one.update(graph)
        # true if arrivals may be on several topics
        self.is_one_of_many = len(self._selections) > 1 or any(
            isinstance(one, TopicPattern) and not one.is_literal for one in self._selections
        )
        wanted = {channel for one in self._selections for channel in one.channels()}
        # A simulator publishes the time rarely if nobody subscribes to it.
        channels = sorted(wanted | {CLOCK_TOPIC} if self._clock.is_simulated else wanted)
        if channels != self._announced:
            self._announced = channels
            self._monitor.listen_to(channels)


T = TypeVar("T")


def taken(
    stream: ArrivalStream,
    process: Callable[[SelectedPacket], T | None],
    timeout: float | None,
    notify: Callable[[str], None] = lambda _: None,
) -> Iterator[T]:
    """Yield the result of ``process`` for each packet; see ``taken_together``."""
    for results in taken_together(stream, process, timeout, notify, most=1):
        yield from results


def taken_together(
    stream: ArrivalStream,
    process: Callable[[SelectedPacket], T | None],
    timeout: float | None,
    notify: Callable[[str], None] = lambda _: None,
    *,
    most: int,
) -> Iterator[list[T]]:
    """Yield the results of ``process`` for packets that arrived together; None is skipped.

    A list has at most ``most`` results, and no result waits for a later arrival. ``timeout`` is the
    longest time without a result [s], None for no limit. ``notify`` is called with a sentence if
    the first result takes long.

    Raises:
        NothingReceived: There was no result for ``timeout`` seconds.
        LcmtoolsError: The log has ended without a message on the topics.
    """
    began = last = time.monotonic()
    has_notified = has_arrived = has_compared = False
    while True:
        try:
            batch = stream.receive(_WAIT if timeout is None else min(_WAIT, timeout))
        except EOFError:
            if not has_arrived:
                raise LcmtoolsError(
                    f"there is nothing on {stream.text} in the log", stream.contents()
                ) from None
            _notify_silent(stream, notify, has_ended=True)
            return
        has_arrived = has_arrived or bool(batch.arrivals)
        for results in _results(batch.arrivals, process, most):
            last, has_notified = time.monotonic(), True
            yield results
        now = time.monotonic()
        if has_arrived and not has_compared and now - began >= PATIENCE:
            has_compared = True
            _notify_silent(stream, notify)
        waited = now - last
        if timeout is not None and waited >= timeout:
            what = "nothing that can be shown" if has_arrived else "nothing"
            raise NothingReceived(
                f"{what} came on {stream.text} within {timeout:g} s", stream.situation()
            )
        if not has_notified and waited >= PATIENCE:
            has_notified = True
            what = "no message that can be shown" if has_arrived else "no message"
            notify(f"{what} on {stream.text} yet; {stream.situation()}")


def _notify_silent(
    stream: ArrivalStream, notify: Callable[[str], None], *, has_ended: bool = False
) -> None:
    """Say on which topics nothing has come, and which topic was probably meant."""
    for text in stream.silent():
        if has_ended:
            notify(f"the log has no message on {text}; {stream.near(text)}")
        else:
            notify(f"no message on {text} yet; {stream.situation(text)}")


def _results(
    arrivals: Sequence[SelectedPacket], process: Callable[[SelectedPacket], T | None], most: int
) -> Iterator[list[T]]:
    """The results in lists of at most ``most``; those taken before an error are yielded first."""
    results: list[T] = []
    try:
        for arrival in arrivals:
            if (result := process(arrival)) is not None:
                results.append(result)
            if len(results) == most:
                yield results
                results = []
    except LcmtoolsError:
        if results:
            yield results
        raise
    if results:
        yield results
