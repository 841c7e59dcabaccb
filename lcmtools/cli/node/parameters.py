"""The section of ``lcmtools node info`` that only the node itself can fill: its parameters."""

from collections.abc import Sequence

from lcmtools.bus.url import BusUrl
from lcmtools.cli.param.common import block, json_values
from lcmtools.graph.model import Node
from lcmtools.publish.parameters import Answers, ParameterClient, has_parameters

_TIMEOUT = 0.5  # [s]: who asks for the node's connections does not wait for a busy node


def ask(nodes: Sequence[Node], url: BusUrl) -> Answers:
    """The parameters of the nodes that have any and answer in time."""
    able = [node for node in nodes if _can_be_asked(node)]
    return ParameterClient(url, _TIMEOUT).get_all(able)[0]


def text(node: Node, known: Answers) -> list[str]:
    """The lines of the section."""
    if not _can_be_asked(node):
        return []
    if node.name not in known:
        return ["Parameters: (did not answer)"]
    return ["Parameters: ", *block(known[node.name], " * ")]


def record(node: Node, known: Answers) -> dict[str, object]:
    """The section for JSON: null where the node was not asked or did not answer."""
    found = known.get(node.name)
    return {"parameters": None if found is None else json_values(found)}


def _can_be_asked(node: Node) -> bool:
    return has_parameters(node) and not node.stale
