"""The stream of a steered topic: its type, the nodes that obey it, and others that command it."""

import os

from lcmtools.errors import LcmtoolsError
from lcmtools.graph.model import Graph, NodeInfo, Topic
from lcmtools.gui.protocol import Json
from lcmtools.gui.source import Source, absence
from lcmtools.gui.streams.base import PageStream, Update
from lcmtools.gui.velocity import USUAL, commands_velocity
from lcmtools.messages.registry import message_class
from lcmtools.observe.reading.senders import is_here

_RECENT = 2_000_000_000  # [ns] since the last message of a commanding program
_MOST_NAMED = 3  # topics in a hint


class Steer(PageStream):
    """The state of a topic that commands a velocity."""

    period = 0.25
    is_shared = True

    def __init__(self, source: Source, *, topic: str) -> None:
        super().__init__(source)
        self._steered = topic
        if source.steering:
            source.steering.prepare()

    def update(self) -> Update:
        """Return the known facts about the topic."""
        graph = self.source.latest.graph
        topic = graph.topic(self._steered)
        data: dict[str, Json] = {
            "topic": self._steered,
            "type": "" if self._mistake() else self._type(),
            "listeners": [node.name for node, _ in topic.subscribers if _obeys(node)],
            "others": self._others(graph, topic),
        }
        return Update(data)

    def problem(self) -> str:
        """Return why it cannot be steered, or that no program is known to obey."""
        if not self._steered:
            has_any = any(is_velocity(*row.types[:1]) for row in self.source.latest.rows)
            return "choose a topic" if has_any else "no topic commands a velocity yet"
        if mistake := self._mistake():
            return mistake
        topic = self.source.latest.graph.topic(self._steered)
        if any(_obeys(node) for node, _ in topic.subscribers):
            return ""
        row = self.source.latest.row(self._steered)
        missing = "" if row.types or row.senders else absence(self.source, self._steered)
        if "did you mean" in missing:
            return missing
        if programs := self.source.latest.plain_listeners:
            said = f"no node obeys {self._steered}; listening, to what is not known: "
            return said + ", ".join(programs)
        return self._with_others("no node obeys")

    def _others(self, graph: Graph, topic: Topic) -> list[str]:
        nodes = {node.name: end for node, end in topic.publishers if not self._is_own(node)}
        found = [name for name, end in nodes.items() if graph.time - end.last_time < _RECENT]
        if any(graph.time - one.last_time < _RECENT for one in topic.foreign):
            known = {node.name for node, _ in topic.publishers}
            senders = self.source.latest.row(self._steered).senders
            found += [name for name in senders if name not in known]
        return found

    def _is_own(self, node: NodeInfo) -> bool:
        """Return True for the nodes that publish for this server's pages."""
        pids = {os.getpid()} | (self.source.steering.pids if self.source.steering else set())
        return node.pid in pids and is_here(node)

    def _type(self) -> str:
        types = self.source.latest.row(self._steered).types
        return types[0] if types else USUAL

    def _mistake(self) -> str:
        """Return why the topic's type cannot be steered; "" if it can."""
        kind = self._type()
        if is_velocity(kind):
            return ""
        return self._with_others(f"{kind} commands no velocity, and that is the type of")

    def _with_others(self, what: str) -> str:
        """Return a sentence about the topic, with topics that some node obeys."""
        rows = self.source.latest.rows
        others = [one.channel for one in rows if one.listeners and is_velocity(*one.types[:1])]
        hint = f"; obeyed are {', '.join(others[:_MOST_NAMED])}" if others else ""
        return f"{what} {self._steered}{hint}"


def is_velocity(kind: str = "") -> bool:
    """Return whether the type with this name commands a velocity; False if it is unknown."""
    try:
        return bool(kind) and commands_velocity(message_class(kind))
    except LcmtoolsError:
        return False


def _obeys(node: NodeInfo) -> bool:
    return not (node.stale or node.tool)
