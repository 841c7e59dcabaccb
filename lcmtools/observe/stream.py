"""The messages of the topics that some arguments mean, as they come."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from lcmtools.cli.output import talk
from lcmtools.errors import LcmtoolsError, NothingReceived
from lcmtools.graph.model import Graph
from lcmtools.messages.path import Path
from lcmtools.names import Resolver, is_hidden
from lcmtools.observe.arrival import CLOCK, ArrivalClock, is_simulated
from lcmtools.observe.find import GLOBAL, known_spelling, near_topic
from lcmtools.observe.monitor import BusMonitor
from lcmtools.observe.selection import OneTopic, TopicPattern
from lcmtools.wire.packet import Packet

_PATIENCE = 2.0  # [s] without a message before the person is told what is on the bus
_LOOK_PERIOD = 0.5  # [s] between looks for topics that a pattern matches
_MOST_NAMED = 8  # of topics in a line


@dataclass(frozen=True, slots=True)
class Match:
    """A message that is wanted.

    Attributes:
        packet: The message.
        path: The field path behind its topic.
        time: When it came, by the clock that stamps go by: simulated time where there is any [ns].
        is_one_of_many: Others may be of other topics, so that each must say which it is of.
    """

    packet: Packet
    path: Path
    time: int
    is_one_of_many: bool = False


class Stream:
    """The topics that arguments mean, and their messages.

    Args:
        monitor: The bus.
        wanted: What the arguments mean.
        names: The namespace and the remaps of topics.

    Raises:
        UsageError: What follows a topic is no field path.
    """

    def __init__(
        self,
        monitor: BusMonitor,
        wanted: Sequence[OneTopic | TopicPattern],
        names: Resolver = GLOBAL,
    ) -> None:
        self._names_ = names
        self._monitor = monitor
        self._wanted = wanted
        self._known: set[str] = set()
        self._announced: list[str] = []
        self._next_look = 0.0
        self._clock = ArrivalClock(is_simulated=False)
        self._learn()

    @property
    def paths(self) -> list[tuple[tuple[str, ...], Path]]:
        """The types that nodes announce for each topic named, and the path behind it."""
        graph = self._monitor.graph()
        named = [one for one in self._wanted if isinstance(one, OneTopic)]
        spellings = [known_spelling(graph, one.text, self._names_) for one in named]
        return [
            (graph.topic(spelling).types if spelling else (), one.path)
            for one, spelling in zip(named, spellings, strict=True)
        ]

    def texts(self, show: Callable[[Match], str | None], timeout: float | None) -> Iterator[str]:
        """What is to be printed for the messages; tells the person when it takes long.

        Args:
            show: The text of a message, None for one that is to be passed over.
            timeout: Longest time without a text [s].

        Raises:
            NothingReceived: There was none for ``timeout`` seconds.
            UsageError: What follows a topic is no field path.
            LcmtoolsError: The log has ended, and nothing in it is wanted.
        """
        last = time.monotonic()
        told = came = False
        while (matches := self._pull(0.2 if timeout is None else min(0.2, timeout))) is not None:
            for match in matches:
                came = True
                text = show(match)
                if text is not None:
                    last, told = time.monotonic(), True
                    yield text
            waited = time.monotonic() - last
            if timeout is not None and waited >= timeout:
                what = "nothing that can be shown" if came else "nothing"
                raise NothingReceived(
                    f"{what} came on {self._names()} within {timeout:g} s", self._hint()
                )
            if not told and waited >= _PATIENCE:
                told = True
                what = "no message that can be shown" if came else "no message"
                talk(f"lcmtools echo: {what} on {self._names()} yet; {self._hint()}")
        self._check_end(came=came)

    def _check_end(self, *, came: bool) -> None:
        """Complain where nothing in a log was meant."""
        if not came:
            seen = self._monitor.graph().topic_names()
            has = f"it has {', '.join(seen[:_MOST_NAMED])}" if seen else "no message is in it"
            raise LcmtoolsError(f"nothing is on {self._names()} in the log", has)

    def _pull(self, timeout: float) -> list[Match] | None:
        """The next messages that are wanted; None at the end of a log."""
        try:
            packets = self._monitor.receive(timeout)
        except EOFError:
            return None
        is_new = any(packet.channel not in self._known for packet in packets)
        if is_new or time.monotonic() >= self._next_look:
            self._learn()
            self._known.update(packet.channel for packet in packets)
        return [match for packet in packets for match in self._matches(packet)]

    def _matches(self, packet: Packet) -> Iterator[Match]:
        self._clock.hear(packet)
        time_of_arrival = self._clock.time(packet) or packet.time
        is_one_of_many = len(self._wanted) > 1 or any(
            isinstance(one, TopicPattern) and not one.is_literal for one in self._wanted
        )
        seen = set()
        for one in self._wanted:
            path = one.path_on(packet.channel)
            if path is not None and path not in seen:
                seen.add(path)
                yield Match(packet, path, time_of_arrival, is_one_of_many)

    def _learn(self) -> None:
        """Tell topics from paths, find what patterns match, and announce to listen to it."""
        self._next_look = time.monotonic() + _LOOK_PERIOD
        graph = self._monitor.graph()
        self._clock.is_simulated = is_simulated(graph)
        for one in self._wanted:
            one.learn(graph)
        wanted = {channel for one in self._wanted for channel in one.channels()}
        # A simulator tells the time seldom where nobody says that he listens to it.
        channels = sorted(wanted | {CLOCK} if self._clock.is_simulated else wanted)
        if channels != self._announced:
            self._announced = channels
            self._monitor.listen_to(channels)

    def _names(self) -> str:
        return ", ".join(one.text for one in self._wanted)

    def _hint(self) -> str:
        """What is said of the first topic that can be found at all; else what is on the bus."""
        graph = self._monitor.graph()
        known = [channel for one in self._wanted for channel in one.channels()]
        published = [channel for channel in known if graph.topic(channel).publishers]
        return situation(graph, published[0] if published else self._wanted[0].text, self._names_)


def situation(graph: Graph, topic: str, names: Resolver) -> str:
    """Who publishes a topic that is waited for; or what may have been meant, or is on the bus."""
    spelling = known_spelling(graph, topic, names)
    if spelling is not None:
        publishers = [node.name for node, _ in graph.topic(spelling).publishers]
        if publishers:
            return f"it is published by {', '.join(publishers)}"
    else:
        near = near_topic(graph, topic, names)
        if near.startswith("did you mean"):
            return near
    seen = [name for name in graph.topic_names() if not is_hidden(name)]
    return f"on the bus: {', '.join(seen[:_MOST_NAMED])}" if seen else "no topic is on the bus"
