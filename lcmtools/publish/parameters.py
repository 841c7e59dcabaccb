"""The parameters of other nodes, several at once: read and changed over the bus."""

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TypeAlias

from lcmtools.bus.url import BusUrl
from lcmtools.errors import LcmtoolsError, ServiceError
from lcmtools.graph.model import Graph, Node, Role
from lcmtools.names import MAX_CHANNEL_BYTES, did_you_mean
from lcmtools.node.parameters import service_name
from lcmtools.node.remote import RemoteParameter, RemoteParameters
from lcmtools.node.service import request_channel
from lcmtools.publish.own_node import own_node

Parameters: TypeAlias = Mapping[str, RemoteParameter]
"""A node's parameters by name."""
Answers: TypeAlias = Mapping[str, Parameters]
"""The parameters of each node that answered, by its name."""

_AT_ONCE = 16
"""Nodes that are read at the same time."""


@dataclass(frozen=True, slots=True)
class ParameterClient:
    """Reads and changes the parameters of nodes.

    Attributes:
        url: The bus.
        timeout: Longest wait for an answer [s].
    """

    url: BusUrl
    timeout: float

    def get_all(self, nodes: Sequence[Node]) -> tuple[Answers, list[ServiceError]]:
        """Return the parameters of nodes, and why some did not answer."""
        if not nodes:
            return {}, []
        with own_node("param", self.url) as own, ThreadPoolExecutor(_AT_ONCE) as pool:
            clients = [RemoteParameters(own, node.name) for node in nodes]
            try:
                found = list(pool.map(self._get, clients))
            except BaseException:
                own.context.stop()  # or Ctrl-C would wait for nodes that do not answer
                raise
        answers = dict(zip((node.name for node in nodes), found, strict=True))
        errors = [answer for answer in found if isinstance(answer, ServiceError)]
        return {n: a for n, a in answers.items() if not isinstance(a, ServiceError)}, errors

    def get(self, node: str) -> Parameters:
        """Return the parameters of one node.

        Raises:
            ServiceError: It did not answer.
        """
        with own_node("param", self.url) as own:
            return RemoteParameters(own, node).get(self.timeout)

    def set(self, node: str, texts: Mapping[str, str]) -> Parameters:
        """Change parameters of one node, all or none; return all that it has.

        Raises:
            RefusedParameters: The node refuses, with the reason.
            ServiceError: It did not answer.
        """
        with own_node("param", self.url) as own:
            return RemoteParameters(own, node).set(texts, self.timeout)

    def _get(self, remote: RemoteParameters) -> Parameters | ServiceError:
        try:
            return remote.get(self.timeout)
        except ServiceError as error:
            return error


def has_parameters(node: Node) -> bool:
    """True if a node announces a service for its parameters."""
    own = service_name(node.name)
    return any(endpoint.topic == own for endpoint in node.having(Role.SERVICE))


def nodes_with_parameters(graph: Graph) -> list[Node]:
    """Return the nodes that have parameters, sorted by name; of one name the living ones."""
    found: dict[str, Node] = {}
    for node in graph.nodes:
        known = found.get(node.name)
        if has_parameters(node) and (known is None or known.stale):
            found[node.name] = node
    return list(found.values())


def require_parameters(node: Node) -> Node:
    """Return the node.

    Raises:
        LcmtoolsError: It has ended, or has no service for its parameters.
    """
    if node.stale:
        raise LcmtoolsError(f"{node.name} {node.stale}", "lcmtools node list shows the nodes")
    if not has_parameters(node):
        raise LcmtoolsError(f"{node.name} cannot be asked for parameters", _why_not(node))
    return node


def pick(parameters: Parameters, name: str, node: str, place: str = "") -> RemoteParameter:
    """Return a parameter by its name.

    Raises:
        LcmtoolsError: The node has none of this name; with a hint at what may have been meant.
    """
    if name not in parameters:
        hint = did_you_mean(name, parameters) or f"it has {', '.join(parameters)}"
        raise LcmtoolsError(f"{place}{node} has no parameter '{name}'", hint)
    return parameters[name]


def _why_not(node: Node) -> str:
    spare = MAX_CHANNEL_BYTES - len(request_channel(service_name("")))
    if len(node.name) > spare:
        return f"its name has {len(node.name)} characters, and with more than {spare} it has none"
    return "it offers no service for that"
