"""Asking nodes for their parameters, several at once."""

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import click

from lcmtools.cli.asker import asking_node
from lcmtools.cli.options import duration, open_monitor
from lcmtools.cli.output import talk
from lcmtools.cli.param.target import with_parameters
from lcmtools.errors import LcmtoolsError, ServiceError, ServiceTimeout
from lcmtools.graph.model import Graph, Node, Staleness
from lcmtools.names import did_you_mean
from lcmtools.node.remote import RemoteParameter, RemoteParameters

Answers = dict[str, dict[str, RemoteParameter]]
"""The parameters of each node that answered, by its name."""

_AT_ONCE = 16
"""Nodes that are asked at the same time."""

timeout_option = click.option(
    "--timeout", type=duration, default=3.0, help="Wait so long for a node's answer (else 3s)."
)


@dataclass(frozen=True, slots=True)
class Asker:
    """Asks nodes.

    Attributes:
        graph: What is on the bus.
        url: The bus.
        timeout: How long to wait for an answer [s].
    """

    graph: Graph
    url: str
    timeout: float

    def ask(self, nodes: Sequence[Node]) -> tuple[Answers, list[ServiceError]]:
        """The parameters of nodes, and why some did not answer."""
        with asking_node("param") as own, ThreadPoolExecutor(_AT_ONCE) as pool:
            clients = [RemoteParameters(own, node.name) for node in nodes]
            try:
                found = list(pool.map(self._get, clients))
            except BaseException:
                own.context.stop()  # or Ctrl-C would wait for whoever does not answer
                raise
        answers: Answers = {}
        errors: list[ServiceError] = []
        for node, answer in zip(nodes, found, strict=True):
            if isinstance(answer, ServiceError):
                errors.append(answer)
            else:
                answers[node.name] = answer
        return answers, errors

    def ask_one(self, node: Node) -> dict[str, RemoteParameter]:
        """The parameters of one node.

        Raises:
            ServiceError: It did not answer.
        """
        with asking_node("param") as own:
            return RemoteParameters(own, node.name).get(self.timeout)

    def set(self, node: Node, texts: Mapping[str, str]) -> dict[str, RemoteParameter]:
        """Change parameters of one node, all or none; return all that it has.

        Raises:
            RefusedParameters: The node refuses, and says why.
            ServiceError: It did not answer.
        """
        with asking_node("param") as own:
            return RemoteParameters(own, node.name).set(texts, self.timeout)

    def _get(self, remote: RemoteParameters) -> "dict[str, RemoteParameter] | ServiceError":
        try:
            return remote.get(self.timeout)
        except ServiceError as error:
            return error


def look(timeout: float) -> Asker:
    """Look at the bus and be ready to ask.

    Raises:
        UsageError: The URL or the domain is wrong.
        BusError: The bus cannot be reached, with what to type.
    """
    with open_monitor("param") as monitor:
        return Asker(monitor.settle(foreign=False), str(monitor.url), timeout)


def living_nodes(graph: Graph, *, show_all: bool) -> list[Node]:
    """All nodes that can be asked; says which ones run and do not answer.

    Args:
        graph: What is on the bus.
        show_all: With those whose names are hidden.
    """
    hang = [n for n in graph.nodes if n.stale is Staleness.HANGS and not (n.tool or n.is_hidden)]
    for node in hang:
        talk(f"{click.get_current_context().command_path}: {node.name} {node.stale}")
    known = with_parameters(graph)
    return [node for node in known if not node.stale and (show_all or not node.is_hidden)]


def complain_of(errors: Sequence[ServiceError]) -> int:
    """Say which nodes did not answer; the exit code."""
    for error in errors:
        talk(f"{click.get_current_context().command_path}: {error}")
    return ServiceTimeout.exit_code if errors else 0


def pick(parameters: Mapping[str, RemoteParameter], name: str, node: str) -> RemoteParameter:
    """A parameter by its name.

    Raises:
        LcmtoolsError: The node has none of this name; with what may have been meant.
    """
    if name not in parameters:
        hint = did_you_mean(name, parameters) or f"it has {', '.join(parameters)}"
        raise LcmtoolsError(f"{node} has no parameter '{name}'", hint)
    return parameters[name]
