"""The section of ``lcmtools node info`` that only the node itself can fill: its parameters."""

from collections.abc import Mapping, Sequence

from lcmtools.cli.param.ask import Asker
from lcmtools.cli.param.shown import block, json_values
from lcmtools.cli.param.target import has_parameters
from lcmtools.graph.model import Graph, Node
from lcmtools.node.remote import RemoteParameter

Known = Mapping[str, Mapping[str, RemoteParameter]]
"""The parameters of the nodes that answered, by the nodes' names."""

_TIMEOUT = 0.5  # [s]: who asks for the node's connections does not wait for a busy node


def ask(nodes: Sequence[Node], graph: Graph) -> Known:
    """The parameters of the nodes that can be asked and answer in time."""
    able = [node for node in nodes if _can_be_asked(node)]
    return Asker(graph, "", _TIMEOUT).ask(able)[0] if able else {}


def text(node: Node, known: Known) -> list[str]:
    """The lines of the section."""
    if not _can_be_asked(node):
        return []
    if node.name not in known:
        return ["Parameters: (did not answer)"]
    return ["Parameters: ", *block(known[node.name], " * ")]


def record(node: Node, known: Known) -> dict[str, object]:
    """The section for JSON: null where the node was not asked or did not answer."""
    found = known.get(node.name)
    return {"parameters": None if found is None else json_values(found)}


def _can_be_asked(node: Node) -> bool:
    return has_parameters(node) and not node.stale
