"""Finding the topic or the node that a word on the command line means."""

from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.graph.model import Graph, Node, Topic
from lcmtools.names import Resolver, base_name_of, closest, did_you_mean, is_hidden
from lcmtools.observe.monitor import BusMonitor

GLOBAL = Resolver()
"""Relative names are in "/", and none is remapped."""


def ask_nodes(monitor: BusMonitor) -> Graph:
    """Return what the nodes say; at once on a log, where nobody can be asked."""
    return monitor.graph() if monitor.is_log else monitor.settle(foreign=False)


def known_spelling(graph: Graph, name: str, names: Resolver = GLOBAL) -> str | None:
    """The channel on the bus that a topic's name means; None when none is there."""
    known = set(graph.topic_names())
    return next((spelling for spelling in names.spellings(name) if spelling in known), None)


def find_topic(graph: Graph, name: str, names: Resolver = GLOBAL) -> Topic:
    """The topic that a name means.

    Raises:
        LcmtoolsError: It is not on the bus; with what may have been meant.
    """
    spelling = known_spelling(graph, name, names)
    if spelling is None:
        raise LcmtoolsError(
            f"unknown topic {names.spellings(name)[-1]}", near_topic(graph, name, names)
        )
    return graph.topic(spelling)


def find_node(graph: Graph, name: str) -> Node:
    """The node that a name means: its full name, or the last part where that is unique.

    Or its pid, alone or as HOST:PID. Where a node was killed and started again, the one that is
    alive.

    Raises:
        UsageError: The name is empty.
        LcmtoolsError: There is none, or there are several.
    """
    return find_nodes(graph, name)[0]


def find_nodes(graph: Graph, name: str) -> list[Node]:
    """The nodes that a name means: several where they have the same name, or the same pid.

    Raises:
        UsageError: The name is empty.
        LcmtoolsError: There is none, or nodes of different names are meant.
    """
    if not name:
        raise UsageError("the node's name is empty", "lcmtools node list shows them")
    by_pid = [node for node in graph.nodes if name in _numbers(node)]
    named = graph.named(name) or by_pid
    found = [node for node in named if not node.stale] or named
    names = sorted({node.name for node in found})
    if not found:
        raise LcmtoolsError(f"unknown node {name}", near_node(graph, name))
    if len(names) > 1 and not by_pid:
        raise LcmtoolsError(f"several nodes are named {name}", f"write one of {', '.join(names)}")
    return found


def _numbers(node: Node) -> list[str]:
    """The spellings of a node's process: its pid, alone or behind its computer: "ada:1234"."""
    computers = [node.host, *([node.sender.address] if node.sender else [])]
    return [str(node.pid), *(f"{computer}:{node.pid}" for computer in computers)]


def near_node(graph: Graph, name: str) -> str:
    """A hint at the node that may have been meant instead."""
    known = [node.name for node in graph.nodes if not node.is_hidden]
    by_base = {base_name_of(full): full for full in known}
    near = closest(base_name_of(name), by_base)
    if base_name_of(name) in by_base:
        return f"did you mean {by_base[base_name_of(name)]}?"
    full = name if name.startswith("/") else f"/{name}"
    if hint := did_you_mean(full, known):
        return hint
    return f"did you mean {by_base[near[0]]}?" if near else "lcmtools node list shows them"


def near_topic(graph: Graph, name: str, names: Resolver = GLOBAL) -> str:
    """A hint at the topic that may have been meant instead."""
    known = [topic for topic in graph.topic_names() if not is_hidden(topic)]
    by_base = [topic for topic in known if topic.rpartition("/")[2] == name.rpartition("/")[2]]
    if by_base:
        return f"did you mean {by_base[0]}?"
    return did_you_mean(names.spellings(name)[-1], known) or "lcmtools list shows the topics"
