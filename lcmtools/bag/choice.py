"""Choosing the topics to record, by their names and by nodes."""

from collections.abc import Sequence

from lcmtools.bounded import BoundedDict
from lcmtools.graph.builder import MOST_FLOWS
from lcmtools.graph.model import Graph, Role
from lcmtools.graph.protocol import PROTOCOL_CHANNELS
from lcmtools.names import Pattern, Resolver, has_wildcard, is_hidden
from lcmtools.observe.reading.find import near_node, near_topic

_OF_TOPICS = (Role.PUBLISHER, Role.SUBSCRIBER)


class RecordedTopics:
    """A choice of topics and patterns; if empty, all topics, unless nodes are named.

    The topics of ``nodes`` are those that they publish and subscribe to. With ``hidden``, hidden
    topics belong to "all topics" and match patterns.
    """

    def __init__(
        self,
        topics: Sequence[str],
        names: Resolver,
        *,
        exclude: Sequence[str] = (),
        nodes: Sequence[str] = (),
        hidden: bool = False,
    ) -> None:
        self._hidden = hidden
        self._names = names
        self._is_all = not topics and not nodes
        self._wanted = self._read(topics, hidden=hidden)
        self._unwanted = self._read(exclude, hidden=True)
        self._nodes = {node: Pattern(node, names.namespace, hidden=True) for node in nodes}
        self._of_nodes: set[str] = set()
        self._cache = BoundedDict[str, bool](MOST_FLOWS)
        self.named = () if nodes or any(map(has_wildcard, topics)) else tuple(topics)
        """The topics, if all are named individually; empty if there may be any number."""

    def update(self, graph: Graph) -> list[str]:
        """Add the topics of the graph; return all wanted topics that are known."""
        chosen = [
            node
            for node in graph.nodes
            if any(pattern.means_node(node.name) for pattern in self._nodes.values())
        ]
        ends = (end for node in chosen for end in node.endpoints)
        self._of_nodes = {end.topic for end in ends if end.role in _OF_TOPICS}
        self._cache.clear()
        named = {spelling for name in self.named for spelling in self._names.spellings(name)}
        return sorted(filter(self._is_wanted, named.union(graph.topic_names())))

    def includes(self, channel: str) -> bool:
        """Return whether the channel of a message is wanted."""
        known = self._cache.use(channel)
        if known is None:
            known = self._cache[channel] = self._is_wanted(channel)
        return known

    def silent(self, graph: Graph) -> list[str]:
        """Return a sentence on each unknown named node and each topic without a message."""
        known = graph.topic_names()
        spellings = {name: self._names.spellings(name) for name in self.named}
        return [
            f"no node {name} yet; {near_node(graph, name)}"
            for name, pattern in self._nodes.items()
            if not any(pattern.means_node(node.name) for node in graph.nodes)
        ] + [
            f"no message on {name} yet; {near_topic(known, name, self._names)}"
            for name, channels in spellings.items()
            if not set(channels).intersection(known)
        ]

    def spelled(self, name: str, channel: str) -> bool:
        """Return whether a channel is the topic for a name."""
        return channel in self._names.spellings(name)

    def _is_wanted(self, channel: str) -> bool:
        if channel in PROTOCOL_CHANNELS or self._matches(channel, self._unwanted):
            return False
        if self._is_all:
            return self._hidden or not is_hidden(channel)
        return channel in self._of_nodes or self._matches(channel, self._wanted)

    def _read(self, words: Sequence[str], *, hidden: bool) -> list[Pattern | str]:
        namespace = self._names.namespace
        return [
            Pattern(word, namespace, hidden=hidden) if has_wildcard(word) else word
            for word in words
        ]

    def _matches(self, channel: str, words: Sequence[Pattern | str]) -> bool:
        return any(
            self.spelled(word, channel) if isinstance(word, str) else word.matches(channel)
            for word in words
        )
