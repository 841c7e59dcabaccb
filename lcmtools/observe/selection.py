"""What an argument of ``echo`` means: a topic, or all that a pattern matches, and a field path.

Belongs here: telling topics from the field paths behind them, which only the bus can decide. Must
not know how a message is shown.
"""

import re
from collections.abc import Iterable
from typing import Protocol

from lcmtools.cli.options import topic_spellings
from lcmtools.graph.model import Graph, Topic
from lcmtools.messages.path import Path, parse_path, splits
from lcmtools.names import is_hidden

_WILDCARD = re.compile(r"\*\*|[*?]")
_MEANINGS = {"**": ".*", "*": "[^/]*", "?": "[^/]"}


class Wanted(Protocol):
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

    Raises:
        UsageError: It is empty.
    """

    def __init__(self, argument: str) -> None:
        self.text = argument
        self.path = Path()
        self._is_found = False
        self._spellings = topic_spellings(argument)

    def learn(self, graph: Graph) -> None:
        """Tell the topic from the path, as soon as the topic is on the bus."""
        if self._is_found:
            return
        names = set(graph.topic_names())
        for topic, rest in splits(self.text):
            there = names.intersection(topic_spellings(topic))
            if any(_is_there(graph.topic(name)) for name in there):
                self.text, self.path, self._is_found = topic, parse_path(rest), True
                self._spellings = topic_spellings(topic)
                return

    def path_on(self, channel: str) -> Path | None:
        """The path, on the topic."""
        return self.path if channel in self._spellings else None

    def channels(self) -> Iterable[str]:
        """All that the name may mean: a plain LCM channel, or a topic."""
        return self._spellings


class Pattern:
    """All topics that a pattern matches, and the field path behind each of them.

    ``*`` stands for any characters but "/", ``**`` for any at all, ``?`` for one. Hidden topics are
    left out, unless the pattern has a hidden part itself. A topic whose name is the pattern, to the
    letter, is meant alone.

    Args:
        argument: As it was typed.

    Raises:
        UsageError: There is something wrong with the field path behind it.
    """

    def __init__(self, argument: str) -> None:
        self.text = argument
        _, bracket, index = _WILDCARD.split(argument)[-1].partition("[")
        parse_path(bracket + index)  # what is wrong with it is said at once
        self._readings = [(_matcher(topic), rest) for topic, rest in _readings(argument)]
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
        if is_hidden(channel) and not is_hidden(self.text):
            return None
        found = (rest for matcher, rest in self._readings if matcher.fullmatch(channel))
        rest = next(found, None)
        return None if rest is None else parse_path(rest)


def wanted(argument: str) -> OneTopic | Pattern:
    """What an argument means.

    Raises:
        UsageError: It is empty.
    """
    return Pattern(argument) if _WILDCARD.search(argument) else OneTopic(argument)


def _readings(argument: str) -> Iterable[tuple[str, str]]:
    """All ways to read a pattern as topics with a field path behind them, longest topic first.

    A wildcard is never in the path. With ``**``, which would take the path's names for topics',
    there is no path.
    """
    if "**" in argument:
        return [(argument, "")]
    return [(topic, rest) for topic, rest in splits(argument) if not _WILDCARD.search(rest)]


def _matcher(topic: str) -> re.Pattern[str]:
    """What matches the channels of a pattern: as written or, where it is relative, resolved too."""
    end, parts = 0, []
    for wildcard in _WILDCARD.finditer(topic):
        parts += [re.escape(topic[end : wildcard.start()]), _MEANINGS[wildcard[0]]]
        end = wildcard.end()
    namespace = "" if topic.startswith("/") else topic_spellings("a")[-1].removesuffix("a")
    root = f"(?:{re.escape(namespace)})?"
    return re.compile(root + "".join(parts) + re.escape(topic[end:]), re.DOTALL)


def _is_there(topic: Topic) -> bool:
    """Whether anybody has to do with the topic but commands that look for it."""
    nodes = any(not node.tool for node, _ in topic.subscribers)
    return bool(topic.publishers or topic.traffic or nodes)
