"""``lcmtools param list``, ``get``, ``describe`` and ``dump``."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from lcmtools.cli import bus, options
from lcmtools.cli.bus import in_names, notify
from lcmtools.cli.declare import argument, examples, option, subcommand
from lcmtools.cli.options import all_option, json_option, looking_options
from lcmtools.cli.output import document, lines, show, talk
from lcmtools.errors import LcmtoolsError, ServiceError, ServiceTimeout, UsageError, os_errors_as
from lcmtools.graph.model import Graph, Node, Staleness
from lcmtools.messages.plain import finite
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

timeout_option = options.timeout_option(3.0)


def look(timeout: float) -> tuple[Graph, ParameterClient]:
    """Return the nodes on the bus, and a client for their parameters."""
    graph, url = bus.look("param")
    return graph, ParameterClient(url, timeout)


def living_nodes(graph: Graph, *, show_all: bool) -> list[Node]:
    """Return the nodes with parameters; print which ones run and do not answer."""
    for node in graph.nodes:
        if node.stale is Staleness.HANGS and not (node.tool or node.is_hidden):
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


def json_values(parameters: Parameters) -> dict[str, object]:
    """The values of a node's parameters for JSON."""
    return {name: finite(parameter.value()) for name, parameter in parameters.items()}


def _all_json(answers: Answers) -> dict[str, object]:
    return {node: json_values(parameters) for node, parameters in answers.items()}


def _record(node: str, parameter: RemoteParameter) -> dict[str, object]:
    """A parameter with its description and range, for JSON."""
    return {
        "node": node,
        "name": parameter.name,
        "type": parameter.kind,
        "value": finite(parameter.value()),
        "description": parameter.description,
        "minimum": parameter.minimum or None,
        "maximum": parameter.maximum or None,
        "read_only": parameter.read_only,
    }


@subcommand("list", timeout_option, all_option, json_option, looking_options)
@examples("param list", "param list simple_controller -v")
@argument("node", default="", completer="bus:nodes")
@option("-t", "--show-types", is_flag=True, help="Show each parameter's type.")
@option("-v", "--values", "show_values", is_flag=True, help="Show each parameter's value.")
def list_parameters(
    node: str, *, show_types: bool, show_values: bool, timeout: float, show_all: bool, as_json: bool
) -> int:
    """List the parameters of the nodes on the bus, by their full names.

    NODE may be a namespace too. The exit code is 4 if a node does not answer.
    """
    graph, client = look(timeout)
    named = find_target(graph, [in_names(node)]).nodes if node else None
    nodes = living_nodes(graph, show_all=show_all) if named is None else named
    answers, errors = client.get_all(nodes)
    found = [(name, p) for name, parameters in answers.items() for p in parameters.values()]
    rows = (
        f"{name}/{p.name}{f' [{p.kind}]' * show_types}{f': {p.text}' * show_values}"
        for name, p in found
    )
    show([_record(name, p) for name, p in found], rows, as_json=as_json)
    if not nodes:
        talk(f"no node with parameters on {client.url}")
    return complain_of(errors)


@subcommand("get", timeout_option, json_option, looking_options)
@examples(
    "param get simple_controller kp", "param get /husky0/simple_controller/kp", "param get /husky0"
)
@argument("node", completer="bus:parameters")
@argument("name", default="", completer="bus:parameters")
@option("-p", "--pretty", "is_pretty", is_flag=True, help="Print strings without quotes.")
@option("--hide-type", is_flag=True, hidden=True, help="As it is here anyway.")
def get(
    node: str, name: str, *, is_pretty: bool, hide_type: bool, timeout: float, as_json: bool
) -> int:
    """Print a parameter: NODE NAME, or /node/name as in rosparam.

    Without a name: all parameters of the node, or of all nodes in a namespace.
    """
    del hide_type
    graph, client = look(timeout)
    target = find_target(graph, [in_names(node), *([name] if name else [])])
    if target.is_namespace:
        answers, errors = client.get_all(target.nodes)
        show(_all_json(answers), tree(answers), as_json=as_json)
        return complain_of(errors)
    found = client.request(target.node.name)
    if target.parameter is None:
        show(json_values(found), block(found), as_json=as_json)
        return 0
    parameter = pick(found, target.parameter, target.node.name)
    value = parameter.value()
    text = value if is_pretty and isinstance(value, str) else parameter.text
    show(finite(value), text.split("\n"), as_json=as_json)
    return 0


@subcommand("describe", timeout_option, json_option, looking_options)
@examples("param describe simple_controller kp", "param describe /husky0/simple_controller")
@argument("node", completer="bus:parameters")
@argument("name", default="", completer="bus:parameters")
def describe(node: str, name: str, *, timeout: float, as_json: bool) -> None:
    """Show a parameter's type, value, description and range; all parameters without a NAME."""
    graph, client = look(timeout)
    target = find_target(graph, [in_names(node), *([name] if name else [])])
    full, wanted = target.node.name, target.parameter
    found = client.request(full)
    parameters = list(found.values()) if wanted is None else [pick(found, wanted, full)]
    rows = (row for parameter in parameters for row in _rows(full, parameter))
    show([_record(full, parameter) for parameter in parameters], rows, as_json=as_json)


def _rows(node: str, parameter: RemoteParameter) -> Iterator[str]:
    yield f"Parameter: {node}/{parameter.name}"
    yield f"  Type: {parameter.kind}"
    yield f"  Value: {parameter.text}"
    if parameter.description:
        yield f"  Description: {parameter.description}"
    if parameter.minimum or parameter.maximum:
        yield f"  Range: {parameter.minimum or '-.inf'} to {parameter.maximum or '.inf'}"
    if parameter.read_only:
        yield "  Read only: it is set when the node starts"


@subcommand("dump", timeout_option, json_option, looking_options)
@examples("param dump simple_controller", "param dump gains.yaml /husky0", "param dump -o all.yaml")
@argument("words", metavar="[FILE] [NODE]", nargs=-1, completer="bus:nodes_and_files")
@option("-o", "--output", metavar="FILE", help="Write to this file.", completer="files")
def dump(words: tuple[str, ...], *, output: str | None, timeout: float, as_json: bool) -> int:
    """Write the parameters of a node, a namespace or all nodes as YAML, for param load.

    Without FILE it prints to standard output.
    """
    graph, client = look(timeout)
    file, nodes = _meant(graph, words, output)
    answers, errors = client.get_all(nodes)
    if as_json:
        document(_all_json(answers))
    elif file in (None, "-"):
        lines(tree(answers))
    elif not errors:  # half of a file is worse than none
        text = "".join(f"{row}\n" for row in tree(answers))
        with os_errors_as(f"cannot write {file}"):
            Path(str(file)).write_text(text, encoding="utf-8")
    return complain_of(errors)


def _meant(
    graph: Graph, words: Sequence[str], output: str | None
) -> tuple[str | None, Sequence[Node]]:
    """The file and the nodes that are meant; rosparam writes the file first, ros2 has no file."""
    files = [*([output] if output else []), *words[:-1]]
    if len(files) > 1:
        raise UsageError("there is more than a file and a node", "see lcmtools param dump --help")
    if not words:
        return output, living_nodes(graph, show_all=True)
    try:
        return files[0] if files else None, find_target(graph, [in_names(words[-1])]).nodes
    except LcmtoolsError:
        if files or not (words[0] == "-" or "." in words[0]):
            raise
        return words[0], living_nodes(graph, show_all=True)
