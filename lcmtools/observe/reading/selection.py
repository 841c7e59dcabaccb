"""The topics that an argument selects (one, or all that a pattern matches), and its field path.

Only the bus can tell a topic from the field path after it. Must not know how a message is shown.
"""

from collections.abc import Iterable
from collections.abc import Set as AbstractSet

from lcmtools.errors import LcmtoolsError
from lcmtools.graph.model import Graph, Topic
from lcmtools.messages.path import Path, parse_path, splits
from lcmtools.names import Pattern, Resolver, has_wildcard, is_hidden
from lcmtools.observe.reading.find import GLOBAL, find_topic, find_topic_and_path


class OneTopic:
    """A topic and, if ``with_path``, the field path after it; raises UsageError if wrong."""

    def __init__(self, argument: str, names: Resolver = GLOBAL, *, with_path: bool = True) -> None:
        self.text = argument
        self.is_fixed = not with_path  # True if it does not depend on the bus's topics
        self._names = names
        self.path = Path()
        self._is_found = self.is_fixed
        self._spellings = self._names.spellings(argument)

    def update(self, graph: Graph) -> None:
        """Tell the topic from the path, as soon as the topic is on the bus."""
        if self._is_found:
            return
        names = set(graph.topic_names())
        for topic, rest in splits(self.text):
            there = names.intersection(self._names.spellings(topic))
            if any(_is_there(graph.topic(name)) for name in there):
                self.text, self.path, self._is_found = topic, parse_path(rest), True
                self._spellings = self._names.spellings(topic)
                return

    def is_told_by(self, channels: AbstractSet[str]) -> bool:
        """Return whether one of these new channels settles which part is the topic."""
        found = (name for topic, _ in splits(self.text) for name in self._names.spellings(topic))
        return not (self._is_found or channels.isdisjoint(found))

    def path_on(self, channel: str) -> Path | None:
        """Return the path for the topic; None for other channels."""
        return self.path if channel in self._spellings else None

    def channels(self) -> Iterable[str]:
        """Return the channels that the name may mean: a plain LCM channel, or a topic."""
        return self._spellings


class TopicPattern:
    """All topics that a pattern matches (see ``names.Pattern``), and the field path after it.

    If a topic's name is exactly the pattern, only this topic is meant. Wildcards are never part of
    the path. A pattern with ``**``, which would take the path's names for topics', has no path. An
    error in the path raises UsageError.
    """

    def __init__(self, argument: str, names: Resolver = GLOBAL, *, with_path: bool = True) -> None:
        self.text = argument
        last = max(argument.rfind("*"), argument.rfind("?"))
        _, bracket, index = argument[last:].partition("[")
        parse_path(bracket + index)  # raises at once if there is an error in it
        is_whole = "**" in argument or not with_path
        readings = [(argument, "")] if is_whole else list(splits(argument))
        self._readings = [  # the longest topic first
            (Pattern(topic, names.namespace, hidden=is_hidden(argument)), rest)
            for topic, rest in readings
            if not has_wildcard(rest)
        ]
        self._paths: dict[str, Path | None] = {}
        self._literal: str | None = None

    @property
    def is_literal(self) -> bool:
        """True if it is the name of a topic on the bus rather than a pattern."""
        return self._literal is not None

    def update(self, graph: Graph) -> None:
        """Find the topics that match now."""
        for name in graph.topic_names():
            if name == self.text and _is_there(graph.topic(name)):
                self._literal = name
            self.path_on(name)

    def is_told_by(self, channels: AbstractSet[str]) -> bool:
        """Return whether one of these new channels has exactly the pattern as its name."""
        return self.text in channels

    def path_on(self, channel: str) -> Path | None:
        """Return the path after the longest reading of the pattern that matches a channel."""
        if self._literal is not None:
            return Path() if channel == self._literal else None
        if channel not in self._paths:
            found = (rest for pattern, rest in self._readings if pattern.matches(channel))
            rest = next(found, None)
            self._paths[channel] = None if rest is None else parse_path(rest)
        return self._paths[channel]

    def channels(self) -> list[str]:
        """Return the known channels that match."""
        if self._literal is not None:
            return [self._literal]
        return [channel for channel, path in self._paths.items() if path is not None]


def select_topics(
    argument: str, names: Resolver = GLOBAL, *, with_path: bool = True
) -> OneTopic | TopicPattern:
    """Return the selection for an argument (see ``OneTopic`` and ``TopicPattern``)."""
    kind = TopicPattern if has_wildcard(argument) else OneTopic
    return kind(argument, names, with_path=with_path)


def selected_topics(graph: Graph, words: Iterable[str], names: Resolver = GLOBAL) -> list[Topic]:
    """Return the topics that names or patterns mean, each once.

    Raises:
        LcmtoolsError: A topic is not on the bus, or none matches a pattern.
    """
    found: dict[str, Topic] = {}
    for word in words:
        is_pattern = has_wildcard(word)
        some = selected_fields(graph, word, names) if is_pattern else ()
        topics = [topic for topic, _ in some] or [find_topic(graph, word, names)]
        found |= {topic.name: topic for topic in topics}
    return list(found.values())


def selected_fields(
    graph: Graph, argument: str, names: Resolver = GLOBAL
) -> list[tuple[Topic, Path]]:
    """Return the topics that an argument means, and the field path after each.

    Raises:
        LcmtoolsError: A topic is not on the bus, or none matches a pattern; a path is wrong.
    """
    if not has_wildcard(argument):
        return [find_topic_and_path(graph, argument, names)]
    pattern = TopicPattern(argument, names)
    pattern.update(graph)
    found = [(graph.topic(name), pattern.path_on(name)) for name in sorted(pattern.channels())]
    if not found:
        raise LcmtoolsError(f"no topic matches {argument}", "lcmtools list shows the topics")
    return [(topic, path) for topic, path in found if path is not None]


def _is_there(topic: Topic) -> bool:
    """Return whether anything but subscribing commands has a topic."""
    nodes = any(not node.tool for node, _ in topic.subscribers)
    return bool(topic.publishers or topic.traffic or nodes)
