"""The node, and which of its parameters, that words mean.

A parameter is named as in rosparam, ``/husky0/driver/gain``, or as in ros2, by two words:
``/husky0/driver gain``. The parameters that a node has are not known here.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.graph.model import Graph, Node
from lcmtools.names import did_you_mean
from lcmtools.observe.find import find_node
from lcmtools.publish.parameters import nodes_with_parameters, require_parameters


@dataclass(frozen=True, slots=True)
class Target:
    """The nodes and the parameter that words mean.

    Attributes:
        nodes: One node; or all of a namespace.
        parameter: A parameter of the only node; None for all parameters.
        is_namespace: A namespace is meant, though there may be only one node in it.
    """

    nodes: tuple[Node, ...]
    parameter: str | None = None
    is_namespace: bool = False

    @property
    def node(self) -> Node:
        """The only node.

        Raises:
            UsageError: It is a namespace.
        """
        if self.is_namespace:
            names = ", ".join(node.name for node in self.nodes)
            raise UsageError("a node is needed here, not a namespace", f"write one of {names}")
        return self.nodes[0]


def find_target(graph: Graph, words: Sequence[str]) -> Target:
    """Return what one word or two mean: a node, a parameter, or a namespace with nodes.

    Raises:
        UsageError: A name is empty.
        LcmtoolsError: There is no such node, or it has no parameters.
    """
    if len(words) > 1:
        node = require_parameters(find_node(graph, words[0]))
        return Target((node,), words[1].removeprefix(f"{node.name}/") or None)
    word = words[0]
    if not word:
        raise UsageError("the name is empty", "lcmtools param list shows the parameters")
    for name, rest in _splits(word.rstrip("/")):
        if any(not node.tool for node in graph.named(name)):
            return Target((require_parameters(find_node(graph, name)),), rest or None)
    known = nodes_with_parameters(graph)
    prefix = f"/{word.strip('/')}/" if word.strip("/") else "/"
    inside = [node for node in known if not node.stale and node.name.startswith(prefix)]
    if inside:
        return Target(tuple(inside), is_namespace=True)
    raise _unknown(word, [node.name for node in known])


def _splits(word: str) -> Iterator[tuple[str, str]]:
    """A name cut into a node's and a parameter's, at each slash, the longest node first."""
    end = len(word)
    while end > 0:
        yield word[:end], word[end + 1 :]
        end = word.rfind("/", 0, end)


def _unknown(word: str, nodes: Sequence[str]) -> LcmtoolsError:
    base = word.rstrip("/").rpartition("/")[0]
    for candidate in filter(None, (word, base)):
        full = candidate if candidate.startswith("/") else f"/{candidate}"
        if hint := did_you_mean(full, nodes):
            return LcmtoolsError(f"there is no node for {word}", hint)
    hint = "lcmtools param list shows the parameters" if nodes else "no node with parameters runs"
    return LcmtoolsError(f"there is no node for {word}", hint)
