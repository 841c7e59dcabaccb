"""The messages of the topic that an argument means, as they come."""

import time
from collections.abc import Callable, Iterator

from lcmtools.bus.watch import Watch
from lcmtools.cli.find import known_spelling, near_topic
from lcmtools.cli.options import topic_spellings
from lcmtools.cli.output import talk
from lcmtools.errors import NothingReceived
from lcmtools.graph.model import Graph, Topic
from lcmtools.messages.path import Path, parse_path, splits
from lcmtools.names import is_hidden
from lcmtools.wire.packet import Packet

_PATIENCE = 2.0  # [s] without a message before the person is told what is on the bus


class Stream:
    """A topic and the field path behind it, which only the bus can tell from one another.

    Attributes:
        topic: As it was written, without the path where that is known.
        path: The field path behind the topic.

    Raises:
        UsageError: The argument is empty, or what follows the topic is no field path.
    """

    def __init__(self, watch: Watch, argument: str) -> None:
        self._watch = watch
        self.topic = argument
        self.path = Path()
        self._is_found = False
        self._possible = {name for topic, _ in splits(argument) for name in topic_spellings(topic)}
        self._find()
        self._listen()

    @property
    def types(self) -> tuple[str, ...]:
        """The types that nodes announce for the topic."""
        graph = self._watch.graph()
        spelling = known_spelling(graph, self.topic)
        return graph.topic(spelling).types if spelling else ()

    def texts(
        self, show: Callable[[Packet, Path], str | None], timeout: float | None
    ) -> Iterator[str]:
        """What is to be printed for the messages; tells the person when it takes long.

        Args:
            show: The text of a packet, None for one that is to be passed over.
            timeout: Longest time without a text [s].

        Raises:
            NothingReceived: There was none for ``timeout`` seconds.
            UsageError: What follows the topic is no field path.
        """
        last = time.monotonic()
        told = came = False
        while (packets := self._pull(0.2 if timeout is None else min(0.2, timeout))) is not None:
            for packet in packets:
                came = True
                text = show(packet, self.path)
                if text is not None:
                    last, told = time.monotonic(), True
                    yield text
            waited = time.monotonic() - last
            if timeout is not None and waited >= timeout:
                what = "nothing that can be shown" if came else "nothing"
                raise NothingReceived(
                    f"{what} came on {self.topic} within {timeout:g} s", self._hint()
                )
            if not told and waited >= _PATIENCE:
                told = True
                what = "no message that can be shown" if came else "no message"
                talk(f"lcmtools echo: {what} on {self.topic} yet; {self._hint()}")

    def _hint(self) -> str:
        return _situation(self._watch.graph(), self.topic)

    def _pull(self, timeout: float) -> list[Packet] | None:
        """The topic's next packets; None at the end of a log."""
        try:
            packets = self._watch.receive(timeout)
        except EOFError:
            return None
        if not self._is_found and any(packet.channel in self._possible for packet in packets):
            self._find()
            self._listen()
        return [packet for packet in packets if packet.channel in self._wanted]

    def _find(self) -> None:
        """Tell the topic from the path, if the topic is on the bus."""
        graph = self._watch.graph()
        names = set(graph.topic_names())
        for topic, rest in splits(self.topic):
            spellings = names.intersection(topic_spellings(topic))
            if any(_is_there(graph.topic(name)) for name in spellings):
                self.topic, self.path, self._is_found = topic, parse_path(rest), True
                return

    def _listen(self) -> None:
        self._wanted = set(topic_spellings(self.topic))
        self._watch.listen_to(topic_spellings(self.topic))


def _is_there(topic: Topic) -> bool:
    """Whether anybody has to do with the topic but commands that look for it."""
    nodes = any(not node.tool for node, _ in topic.subscribers)
    return bool(topic.publishers or topic.traffic or nodes)


def _situation(graph: Graph, topic: str) -> str:
    """What is on the bus instead."""
    spelling = known_spelling(graph, topic)
    if spelling is not None:
        publishers = [node.name for node, _ in graph.topic(spelling).publishers]
        if publishers:
            return f"it is published by {', '.join(publishers)}"
    else:
        near = near_topic(graph, topic)
        if near.startswith("did you mean"):
            return near
    seen = [name for name in graph.topic_names() if not is_hidden(name)]
    return f"on the bus: {', '.join(seen[:8])}" if seen else "no topic is on the bus"
