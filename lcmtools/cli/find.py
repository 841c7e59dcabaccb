"""Finding the topic or the node that a word on the command line means."""

from lcmtools.bus.watch import Watch
from lcmtools.cli.options import topic_spellings
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.graph.model import Graph, Node, Topic
from lcmtools.names import did_you_mean, is_hidden


def ask_nodes(watch: Watch) -> Graph:
    """What the nodes say; at once on a log, which has nobody to ask and would play meanwhile."""
    return watch.graph() if watch.url.provider == "file" else watch.settle(foreign=False)


def known_spelling(graph: Graph, name: str) -> str | None:
    """The channel on the bus that a topic's name means; None when none is there."""
    known = set(graph.topic_names())
    return next((spelling for spelling in topic_spellings(name) if spelling in known), None)


def find_topic(graph: Graph, name: str) -> Topic:
    """The topic that a name means.

    Raises:
        LcmtoolsError: It is not on the bus; with what may have been meant.
    """
    spelling = known_spelling(graph, name)
    if spelling is None:
        raise LcmtoolsError(f"unknown topic {topic_spellings(name)[-1]}", near_topic(graph, name))
    return graph.topic(spelling)


def find_node(graph: Graph, name: str) -> Node:
    """The node that a name means: its full name, or the last part where that is unique.

    Where a node was killed and started again, the one that is alive.

    Raises:
        UsageError: The name is empty.
        LcmtoolsError: There is none, or there are several.
    """
    if not name:
        raise UsageError("the node's name is empty", "lcmtools node list shows them")
    named = graph.named(name)
    found = [node for node in named if not node.stale] or named
    names = sorted({node.name for node in found})
    if not found:
        known = [node.name for node in graph.nodes if not node.is_hidden]
        hint = did_you_mean(name if name.startswith("/") else f"/{name}", known)
        raise LcmtoolsError(f"unknown node {name}", hint or "lcmtools node list shows them")
    if len(names) > 1:
        raise LcmtoolsError(f"several nodes are named {name}", f"write one of {', '.join(names)}")
    return found[0]


def near_topic(graph: Graph, name: str) -> str:
    """A hint at the topic that may have been meant instead."""
    known = [topic for topic in graph.topic_names() if not is_hidden(topic)]
    by_base = [topic for topic in known if topic.rpartition("/")[2] == name.rpartition("/")[2]]
    if by_base:
        return f"did you mean {by_base[0]}?"
    return did_you_mean(topic_spellings(name)[-1], known) or "lcmtools list shows the topics"
