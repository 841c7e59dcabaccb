"""Parts of the ``param`` commands: the look at the bus, and parameters as YAML and JSON."""

import json
from collections.abc import Sequence

import click

from lcmtools.cli.declare import duration, option
from lcmtools.cli.options import open_monitor
from lcmtools.cli.output import talk
from lcmtools.errors import ServiceError, ServiceTimeout
from lcmtools.graph.model import Graph, Node, Staleness
from lcmtools.messages.plain import plain_json
from lcmtools.messages.setting import write_setting
from lcmtools.publish.parameters import (
    Answers,
    ParameterClient,
    Parameters,
    RemoteParameter,
    nodes_with_parameters,
)

timeout_option = option(
    "--timeout", type=duration, default=3.0, help="Wait so long for a node's answer (else 3s)."
)


def look(timeout: float) -> tuple[Graph, ParameterClient]:
    """Return the nodes on the bus, and what reads their parameters."""
    with open_monitor("param") as monitor:
        return monitor.settle(foreign=False), ParameterClient(monitor.url, timeout)


def living_nodes(graph: Graph, *, show_all: bool) -> list[Node]:
    """Return the nodes with parameters; print which ones run and do not answer."""
    hang = [n for n in graph.nodes if n.stale is Staleness.HANGS and not (n.tool or n.is_hidden)]
    for node in hang:
        talk(f"{click.get_current_context().command_path}: {node.name} {node.stale}")
    known = nodes_with_parameters(graph)
    return [node for node in known if not node.stale and (show_all or not node.is_hidden)]


def complain_of(errors: Sequence[ServiceError]) -> int:
    """Print which nodes did not answer; return the exit code."""
    for error in errors:
        talk(f"{click.get_current_context().command_path}: {error}")
    return ServiceTimeout.exit_code if errors else 0


def block(parameters: Parameters, indent: str = "") -> list[str]:
    """The lines of a node's parameters, as YAML."""
    return [f"{indent}{write_setting(name)}: {p.text}" for name, p in parameters.items()]


def tree(answers: Answers) -> list[str]:
    """The lines of several nodes' parameters, below the nodes' names, for ``param load``."""
    return [
        row
        for node, parameters in answers.items()
        for row in (f"{write_setting(node)}:", *block(parameters, "  "))
    ]


def json_value(parameter: RemoteParameter) -> object:
    """A value for JSON; infinities and NaN as text."""
    value = parameter.value()
    if value is None:
        return None
    plain = list(value) if isinstance(value, (list, tuple)) else value
    return json.loads(plain_json(plain))  # type: ignore[arg-type] # a list of scalars


def json_values(parameters: Parameters) -> dict[str, object]:
    """The values of a node's parameters for JSON."""
    return {name: json_value(parameter) for name, parameter in parameters.items()}


def record(node: str, parameter: RemoteParameter) -> dict[str, object]:
    """A parameter with its description and range, for JSON."""
    return {
        "node": node,
        "name": parameter.name,
        "type": parameter.kind,
        "value": json_value(parameter),
        "description": parameter.description,
        "minimum": parameter.minimum or None,
        "maximum": parameter.maximum or None,
        "read_only": parameter.read_only,
    }
