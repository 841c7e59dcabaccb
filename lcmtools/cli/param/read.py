"""``lcmtools param list``, ``get``, ``describe`` and ``dump``."""

import contextlib
import json
from collections.abc import Sequence
from pathlib import Path

from lcmtools.cli.declare import argument, duration, option, subcommand
from lcmtools.cli.options import (
    all_option,
    in_names,
    json_option,
    looking_options,
    notify,
    open_monitor,
)
from lcmtools.cli.output import document, lines, show, talk
from lcmtools.errors import LcmtoolsError, ServiceError, ServiceTimeout, UsageError
from lcmtools.graph.model import Graph, Node, Staleness
from lcmtools.messages.plain import plain_json
from lcmtools.messages.setting import write_setting
from lcmtools.publish.parameters import (
    Answers,
    ParameterClient,
    Parameters,
    RemoteParameter,
    find_target,
    nodes_with_parameters,
    pick,
)

timeout_option = option(
    "--timeout", type=duration, default=3.0, help="Longest wait for an answer (else 3s)."
)


def look(timeout: float) -> tuple[Graph, ParameterClient]:
    """Return the nodes on the bus, and what reads their parameters."""
    with open_monitor("param") as monitor:
        return monitor.settle(foreign=False), ParameterClient(monitor.url, timeout)


def living_nodes(graph: Graph, *, show_all: bool) -> list[Node]:
    """Return the nodes with parameters; print which ones run and do not answer."""
    hang = [n for n in graph.nodes if n.stale is Staleness.HANGS and not (n.tool or n.is_hidden)]
    for node in hang:
        notify(f"{node.name} {node.stale}")
    known = nodes_with_parameters(graph)
    return [node for node in known if not node.stale and (show_all or not node.is_hidden)]


def complain_of(errors: Sequence[ServiceError]) -> int:
    """Print which nodes did not answer; return the exit code."""
    for error in errors:
        notify(f"{error}")
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


@subcommand("list")
@argument("node", default="", completer="bus:nodes")
@option("-t", "--show-types", is_flag=True, help="Show each parameter's type.")
@option("-v", "--values", "show_values", is_flag=True, help="Show each parameter's value.")
@timeout_option
@all_option
@json_option
@looking_options
def list_parameters(
    node: str, *, show_types: bool, show_values: bool, timeout: float, show_all: bool, as_json: bool
) -> int:
    """List the parameters of the nodes on the bus, by their full names.

    NODE may be a namespace too. The exit code is 4 if a node does not answer.

    \b
    Examples:
      lcmtools param list
      lcmtools param list simple_controller -v
    """
    graph, client = look(timeout)
    if node:
        nodes = list(find_target(graph, [in_names(node)]).nodes)
    else:
        nodes = living_nodes(graph, show_all=show_all)
    answers, errors = client.get_all(nodes)
    found = [(name, p) for name, parameters in answers.items() for p in parameters.values()]
    rows = (
        f"{name}/{p.name}{f' [{p.kind}]' * show_types}{f': {p.text}' * show_values}"
        for name, p in found
    )
    show([record(name, p) for name, p in found], rows, as_json=as_json)
    if not nodes:
        talk(f"no node with parameters on {client.url}")
    return complain_of(errors)


@subcommand("get")
@argument("node", completer="bus:parameters")
@argument("name", default="", completer="bus:parameters")
@option("-p", "--pretty", "is_pretty", is_flag=True, help="Print strings without quotes.")
@option("--hide-type", is_flag=True, hidden=True, help="As it is here anyway.")
@timeout_option
@json_option
@looking_options
def get(
    node: str, name: str, *, is_pretty: bool, hide_type: bool, timeout: float, as_json: bool
) -> int:
    """Print a parameter: NODE NAME, or /node/name as in rosparam.

    Without a name: all parameters of the node, or of all nodes in a namespace.

    \b
    Examples:
      lcmtools param get simple_controller kp
      lcmtools param get /husky0/simple_controller/kp
      lcmtools param get /husky0
    """
    del hide_type
    graph, client = look(timeout)
    target = find_target(graph, [in_names(node), name] if name else [in_names(node)])
    if target.is_namespace:
        answers, errors = client.get_all(target.nodes)
        values = {node: json_values(parameters) for node, parameters in answers.items()}
        show(values, tree(answers), as_json=as_json)
        return complain_of(errors)
    found = client.get(target.node.name)
    if target.parameter is None:
        show(json_values(found), block(found), as_json=as_json)
        return 0
    parameter = pick(found, target.parameter, target.node.name)
    value = parameter.value()
    text = value if is_pretty and isinstance(value, str) else parameter.text
    show(json_value(parameter), text.split("\n"), as_json=as_json)
    return 0


@subcommand("describe")
@argument("node", completer="bus:parameters")
@argument("name", default="", completer="bus:parameters")
@timeout_option
@json_option
@looking_options
def describe(node: str, name: str, *, timeout: float, as_json: bool) -> None:
    """Show a parameter's type, value, description and range; all parameters without a NAME.

    \b
    Examples:
      lcmtools param describe simple_controller kp
      lcmtools param describe /husky0/simple_controller
    """
    graph, client = look(timeout)
    target = find_target(graph, [in_names(node), name] if name else [in_names(node)])
    full = target.node.name
    found = client.get(full)
    wanted = target.parameter
    parameters = list(found.values()) if wanted is None else [pick(found, wanted, full)]
    rows = (row for parameter in parameters for row in _rows(full, parameter))
    show([record(full, parameter) for parameter in parameters], rows, as_json=as_json)


def _rows(node: str, parameter: RemoteParameter) -> list[str]:
    rows = [
        f"Parameter: {node}/{parameter.name}",
        f"  Type: {parameter.kind}",
        f"  Value: {parameter.text}",
    ]
    if parameter.description:
        rows.append(f"  Description: {parameter.description}")
    if parameter.minimum or parameter.maximum:
        low, high = parameter.minimum or "-.inf", parameter.maximum or ".inf"
        rows.append(f"  Range: {low} to {high}")
    if parameter.read_only:
        rows.append("  Read only: it is set when the node starts")
    return rows


_MOST_WORDS = 2


@subcommand("dump")
@argument("words", metavar="[FILE] [NODE]", nargs=-1, completer="bus:nodes_and_files")
@option("-o", "--output", metavar="FILE", help="Write to this file.", completer="files")
@timeout_option
@json_option
@looking_options
def dump(words: tuple[str, ...], *, output: str | None, timeout: float, as_json: bool) -> int:
    """Write the parameters of a node, a namespace or all nodes as YAML, for param load.

    Without FILE it prints to standard output.

    \b
    Examples:
      lcmtools param dump simple_controller
      lcmtools param dump gains.yaml /husky0
      lcmtools param dump -o all.yaml
    """
    graph, client = look(timeout)
    file, nodes = _meant(graph, words, output)
    answers, errors = client.get_all(nodes)
    if as_json:
        document({node: json_values(parameters) for node, parameters in answers.items()})
    elif file in (None, "-"):
        lines(tree(answers))
    elif not errors:  # half of a file is worse than none
        _write(str(file), "".join(f"{row}\n" for row in tree(answers)))
    return complain_of(errors)


def _meant(
    graph: Graph, words: Sequence[str], output: str | None
) -> tuple[str | None, Sequence[Node]]:
    """The file and the nodes that are meant; rosparam writes the file first, ros2 has no file."""
    if len(words) > _MOST_WORDS or (output and len(words) > 1):
        raise UsageError("there is more than a file and a node", "see lcmtools param dump --help")
    if not words:
        return output, living_nodes(graph, show_all=True)
    if output or len(words) == _MOST_WORDS:
        return output or words[0], find_target(graph, [in_names(words[-1])]).nodes
    with contextlib.suppress(LcmtoolsError):
        return None, find_target(graph, [*map(in_names, words)]).nodes
    if words[0] == "-" or "." in words[0]:
        return words[0], living_nodes(graph, show_all=True)
    return None, find_target(graph, [*map(in_names, words)]).nodes


def _write(file: str, text: str) -> None:
    try:
        Path(file).write_text(text, encoding="utf-8")
    except OSError as error:
        raise LcmtoolsError(f"cannot write {file}: {error.strerror or error}") from error
