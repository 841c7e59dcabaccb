"""What an argument of ``echo`` means: a topic, or all that a pattern matches, and a field path.

Belongs here: telling topics from the field paths behind them, which only the bus can decide. Must
not know how a message is shown.
"""

from collections.abc import Iterable
from typing import Protocol

from lcmtools.graph.model import Graph, Topic
from lcmtools.messages.path import Path, parse_path, splits
from lcmtools.names import Pattern, Resolver, has_wildcard, is_hidden
from lcmtools.observe.find import GLOBAL


class TopicSelection(Protocol):
    """What one argument means, as far as the bus has told."""

    @property
    def text(self) -> str:
        """The argument; without the field path, where that is told from the topic."""
        ...

    def learn(self, graph: Graph) -> None:
        """See what is on the bus now.

        Raises:
            UsageError: What follows the topic is no field path.
        """
        ...

    def path_on(self, channel: str) -> Path | None:
        """The field path that is asked for on a channel; None for a channel that is not meant."""
        ...

    def channels(self) -> Iterable[str]:
        """The channels to listen to, as far as they are known."""
        ...


class OneTopic:
    """A topic and the field path behind it.

    Args:
        argument: As it was typed.
        names: The namespace and the remaps that it is read by.

    Raises:
        UsageError: It is empty.
    """

    def __init__(self, argument: str, names: Resolver = GLOBAL) -> None:
        self.text = argument
        self._names = names
        self.path = Path()
        self._is_found = False
        self._spellings = self._names.spellings(argument)

    def learn(self, graph: Graph) -> None:
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

    def path_on(self, channel: str) -> Path | None:
        """The path, on the topic."""
        return self.path if channel in self._spellings else None

    def channels(self) -> Iterable[str]:
        """All that the name may mean: a plain LCM channel, or a topic."""
        return self._spellings


class TopicPattern:
    """All topics that a pattern matches (see ``names.Pattern``), and the field path behind them.

    A topic whose name is the pattern, to the letter, is meant alone. A wildcard is never in the
    path. With ``**``, which would take the path's names for topics', there is no path.

    Args:
        argument: As it was typed.
        names: The namespace that a relative pattern is read in.

    Raises:
        UsageError: There is something wrong with the field path behind it.
    """

    def __init__(self, argument: str, names: Resolver = GLOBAL) -> None:
        self.text = argument
        last = max(argument.rfind("*"), argument.rfind("?"))
        _, bracket, index = argument[last:].partition("[")
        parse_path(bracket + index)  # an error in it is found at once
        readings = [(argument, "")] if "**" in argument else list(splits(argument))
        self._readings = [  # the longest topic first
            (Pattern(topic, names.namespace, hidden=is_hidden(argument)), rest)
            for topic, rest in readings
            if not has_wildcard(rest)
        ]
        self._paths: dict[str, Path | None] = {}
        self._literal: str | None = None

    @property
    def is_literal(self) -> bool:
        """Whether it is the name of a topic on the bus, and so no pattern."""
        return self._literal is not None

    def learn(self, graph: Graph) -> None:
        """See which topics match now."""
        for name in graph.topic_names():
            if name == self.text and _is_there(graph.topic(name)):
                self._literal = name
            self.path_on(name)

    def path_on(self, channel: str) -> Path | None:
        """The path behind the longest reading of the pattern that matches a channel."""
        if self._literal is not None:
            return Path() if channel == self._literal else None
        if channel not in self._paths:
            self._paths[channel] = self._read(channel)
        return self._paths[channel]

    def channels(self) -> list[str]:
        """The channels that match, of those that are known."""
        if self._literal is not None:
            return [self._literal]
        return [channel for channel, path in self._paths.items() if path is not None]

    def _read(self, channel: str) -> Path | None:
        found = (rest for pattern, rest in self._readings if pattern.matches(channel))
        rest = next(found, None)
        return None if rest is None else parse_path(rest)


def select_topics(argument: str, names: Resolver = GLOBAL) -> OneTopic | TopicPattern:
    """The topic, or the topics, that an argument means.

    Raises:
        UsageError: It is empty.
    """
    return (TopicPattern if has_wildcard(argument) else OneTopic)(argument, names)


def _is_there(topic: Topic) -> bool:
    """Whether anybody has to do with the topic but commands that look for it."""
    nodes = any(not node.tool for node, _ in topic.subscribers)
    return bool(topic.publishers or topic.traffic or nodes)
