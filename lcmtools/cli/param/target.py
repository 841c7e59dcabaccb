"""Which node, and which of its parameters, the words on a command line mean.

A parameter is named as rosparam names it, ``/husky0/driver/gain``, or as ros2 does, by two words:
``/husky0/driver gain``. What a node answers is not known here.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.graph.model import Graph, Node, Role
from lcmtools.names import MAX_CHANNEL_BYTES, did_you_mean
from lcmtools.node.parameters import service_name
from lcmtools.node.service import request_channel
from lcmtools.observe.find import find_node


@dataclass(frozen=True, slots=True)
class Target:
    """What the words mean.

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


def has_parameters(node: Node) -> bool:
    """Whether a node announces that it can be asked."""
    own = service_name(node.name)
    return any(endpoint.topic == own for endpoint in node.having(Role.SERVICE))


def with_parameters(graph: Graph) -> list[Node]:
    """The nodes that can be asked, sorted by name; of one name the living ones."""
    found: dict[str, Node] = {}
    for node in graph.nodes:
        known = found.get(node.name)
        if has_parameters(node) and (known is None or known.stale):
            found[node.name] = node
    return list(found.values())


def require_parameters(node: Node) -> Node:
    """Return the node, or refuse one that cannot be asked.

    Raises:
        LcmtoolsError: It has ended, or has no service for its parameters.
    """
    if node.stale:
        raise LcmtoolsError(f"{node.name} {node.stale}", "lcmtools node list shows the nodes")
    if not has_parameters(node):
        raise LcmtoolsError(f"{node.name} cannot be asked for parameters", _why_not(node))
    return node


def _why_not(node: Node) -> str:
    spare = MAX_CHANNEL_BYTES - len(request_channel(service_name("")))
    if len(node.name) > spare:
        return f"its name has {len(node.name)} characters, and with more than {spare} it has none"
    return "it offers no service for that"


def find_target(graph: Graph, words: Sequence[str]) -> Target:
    """What one word or two mean: a node, a parameter, or a namespace with nodes.

    Raises:
        UsageError: A name is empty.
        LcmtoolsError: There is no such node, or it cannot be asked.
    """
    if len(words) > 1:
        node = require_parameters(find_node(graph, words[0]))
        return Target((node,), _stripped(words[1], node) if words[1] else None)
    word = words[0]
    if not word:
        raise UsageError("the name is empty", "lcmtools param list shows the parameters")
    namespace = _in_namespace(graph, word)
    for name, rest in _splits(word):
        found = [node for node in graph.named(name) if not node.tool]
        if found:
            return Target((require_parameters(find_node(graph, name)),), rest or None)
    if namespace:
        return Target(tuple(namespace), is_namespace=True)
    raise _unknown(graph, word)


def _stripped(parameter: str, node: Node) -> str:
    """A parameter's name, where it was written in full."""
    return parameter.removeprefix(f"{node.name}/")


def _splits(word: str) -> Iterator[tuple[str, str]]:
    """A name cut into a node's and a parameter's, at each slash, the longest node first."""
    word = word.rstrip("/")
    end = len(word)
    while end > 0:
        yield word[:end], word[end + 1 :]
        end = word.rfind("/", 0, end)


def _in_namespace(graph: Graph, word: str) -> list[Node]:
    prefix = f"/{word.strip('/')}/" if word.strip("/") else "/"
    living = [node for node in with_parameters(graph) if not node.stale]
    return [node for node in living if node.name.startswith(prefix)]


def _unknown(graph: Graph, word: str) -> LcmtoolsError:
    nodes = [node.name for node in with_parameters(graph)]
    base = word.rstrip("/").rpartition("/")[0]
    for candidate in (word, base):
        full = candidate if candidate.startswith("/") else f"/{candidate}"
        hint = did_you_mean(full, nodes) if candidate else ""
        if hint:
            return LcmtoolsError(f"there is no node for {word}", hint)
    hint = "lcmtools param list shows the parameters" if nodes else "no node with parameters runs"
    return LcmtoolsError(f"there is no node for {word}", hint)
