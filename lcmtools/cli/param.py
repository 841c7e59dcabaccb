"""``lcmtools param``."""

import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from lcmtools.cli import bus, options
from lcmtools.cli.bus import in_names, notify
from lcmtools.cli.declare import accepted_for_ros, argument, examples, flag, option, subcommand
from lcmtools.cli.negative_numbers import CommandWithWords
from lcmtools.cli.options import all_option, asking_options, json_option
from lcmtools.cli.output import write_document, write_lines, write_note, write_result
from lcmtools.errors import (
    InvalidFile,
    LcmtoolsError,
    ServiceError,
    ServiceTimeout,
    UsageError,
    os_errors_as,
)
from lcmtools.folders import LARGEST, read_text, write_whole
from lcmtools.graph.model import Graph, NodeInfo, Staleness
from lcmtools.messages.documents import parse_values
from lcmtools.messages.fill import Value
from lcmtools.messages.setting import ANY, text_of
from lcmtools.observe.reading.find import find_node
from lcmtools.publish import parameter_report as report
from lcmtools.publish.parameter_file import changes_of, known_name, make_changes, read_leaves
from lcmtools.publish.remote_parameters import (
    ParameterClient,
    ParameterTarget,
    find_target,
    nodes_with_parameters,
    pick,
    require_parameters,
    value_of,
)

timeout_option = options.timeout_option(3.0)


def look(timeout: float) -> tuple[Graph, ParameterClient]:
    """Return the nodes on the bus, and a client for their parameters."""
    graph, url = bus.look("param")
    return graph, ParameterClient(url, timeout)


def named(graph: Graph, node: str, *name: str) -> ParameterTarget:
    """Return the node, parameter or namespace that the command line names."""
    return find_target(graph, [in_names(node), *filter(None, name)])


def living_nodes(graph: Graph, *, show_all: bool) -> list[NodeInfo]:
    """Return the nodes with parameters, and write a note for those that run but do not answer."""
    for node in graph.nodes:
        if node.stale is Staleness.HANGS and not (node.tool or node.is_hidden):
            notify(f"{node.name} {node.stale}")
    known = nodes_with_parameters(graph)
    return [node for node in known if not node.stale and (show_all or not node.is_hidden)]


def complain_of(errors: Sequence[ServiceError]) -> int:
    """Write which nodes did not answer, and return the exit code."""
    for error in errors:
        notify(f"{error}")
    return ServiceTimeout.exit_code if errors else 0


@subcommand("list", timeout_option, all_option, json_option, asking_options)
@examples("param list", "param list simple_controller -v")
@argument("node", default="", completer="bus:nodes")
@flag("-t", "--show-types", help="Show each parameter's type.")
@flag("-v", "--values", "show_values", help="Show each parameter's value.")
def list_parameters(
    node: str, *, show_types: bool, show_values: bool, timeout: float, show_all: bool, as_json: bool
) -> int:
    """List the parameters of the nodes on the bus, by their full names.

    NODE may be a namespace too. The exit code is 4 if a node does not answer.
    """
    graph, client = look(timeout)
    nodes = named(graph, node).nodes if node else living_nodes(graph, show_all=show_all)
    answers, errors = client.get_all(nodes)
    found = [(name, p) for name, parameters in answers.items() for p in parameters.values()]
    rows = (
        f"{name}/{p.name}{f' [{p.type}]' * show_types}{f': {p.value}' * show_values}"
        for name, p in found
    )
    write_result([report.to_json(*one) for one in found], rows, as_json=as_json)
    if not nodes:
        write_note(f"no node with parameters on {client.url}")
    return complain_of(errors)


@subcommand("get", timeout_option, json_option, asking_options)
@examples(
    "param get simple_controller kp", "param get /husky0/simple_controller/kp", "param get /husky0"
)
@argument("node", completer="bus:parameters")
@argument("name", default="", completer="bus:parameters")
@flag("-p", "--pretty", "is_pretty", help="Print strings without quotes.")
@accepted_for_ros("--hide-type")  # the type is never shown
def get(node: str, name: str, *, is_pretty: bool, timeout: float, as_json: bool) -> int:
    """Print a parameter: NODE NAME, or /node/name as in rosparam.

    Without a name: all parameters of the node, or of all nodes in a namespace.
    """
    graph, client = look(timeout)
    target = named(graph, node, name)
    if target.is_namespace:
        answers, errors = client.get_all(target.nodes)
        write_result(report.all_values(answers), report.tree(answers), as_json=as_json)
        return complain_of(errors)
    found = client.request(target.node.name)
    if target.parameter is None:
        write_result(report.values(found), report.block(found), as_json=as_json)
        return 0
    parameter = pick(found, target.parameter, target.node.name)
    value = value_of(parameter)
    text = value if is_pretty and isinstance(value, str) else parameter.value
    write_result(value, text.split("\n"), as_json=as_json)
    return 0


@subcommand("describe", timeout_option, json_option, asking_options)
@examples("param describe simple_controller kp", "param describe /husky0/simple_controller")
@argument("node", completer="bus:parameters")
@argument("name", default="", completer="bus:parameters")
def describe(node: str, name: str, *, timeout: float, as_json: bool) -> None:
    """Show a parameter's type, value, description and range; all parameters without a NAME."""
    graph, client = look(timeout)
    target = named(graph, node, name)
    full, wanted = target.node.name, target.parameter
    found = client.request(full)
    parameters = list(found.values()) if wanted is None else [pick(found, wanted, full)]
    rows = (row for parameter in parameters for row in report.to_lines(full, parameter))
    write_result(
        [report.to_json(full, parameter) for parameter in parameters], rows, as_json=as_json
    )


_EXAMPLE = "for example: lcmtools param set /husky0/simple_controller kp 0.5"


@subcommand("set", timeout_option, asking_options, cls=CommandWithWords)
@examples(
    "param set simple_controller kp 0.5",
    "param set /husky0/simple_controller/kp 0.5",
    'param set simple_controller "{kp: 0.5, ki: 3.3}"',
)
@argument("words", metavar="NODE NAME VALUE", nargs=-1, completer="bus:parameters")
def set_parameters(words: tuple[str, ...], *, timeout: float) -> None:
    """Set a parameter of a running node: NODE NAME VALUE, or /node/name VALUE.

    VALUE is YAML, of the parameter's type. A dict sets several parameters of a node, all or none.
    The exit code is 1 if the node rejects the change.
    """
    if len(words) <= 1:
        raise UsageError("the value is missing", _EXAMPLE)
    if len(words) > 3:  # noqa: PLR2004 - node, name and value
        raise UsageError("there are more words after the value", "put the value in quotes")
    graph, client = look(timeout)
    target = named(graph, *words[:-1])
    texts = _texts(client, target, words[-1])
    parameters = client.request(target.node.name, texts)
    for name in texts:
        write_note(f"{target.node.name}/{name} is now {parameters[name].value}")


def _texts(client: ParameterClient, target: ParameterTarget, value: str) -> Mapping[str, str]:
    if target.parameter is not None:
        return {target.parameter: value}
    values = parse_values([value])
    if not isinstance(values, dict):
        raise UsageError(
            f"the parameter's name or its value is missing, for {target.node.name}", _EXAMPLE
        )
    known = client.request(target.node.name)
    flat = {known_name(path, known) or "/".join(path): part for path, part in _leaves(values)}
    kinds = {name: known[name].type if name in known else ANY for name in flat}
    return {name: text_of(part, kinds[name]) for name, part in flat.items()}


def _leaves(values: Mapping[str, Value]) -> Iterator[tuple[tuple[str, ...], Value]]:
    """Yield the values of nested dicts, each with the keys that lead to it."""
    for key, part in values.items():
        if part and isinstance(part, Mapping):
            yield from (((key, *path), value) for path, value in _leaves(part))
        else:
            yield (key,), part


@subcommand("dump", timeout_option, json_option, asking_options)
@examples("param dump simple_controller", "param dump gains.yaml /husky0", "param dump -o all.yaml")
@argument("words", metavar="[FILE] [NODE]", nargs=-1, completer="bus:nodes_and_files")
@option("-o", "--output", metavar="FILE", help="Write to this file.", completer="files")
def dump(words: tuple[str, ...], *, output: str | None, timeout: float, as_json: bool) -> int:
    """Write the parameters of a node, a namespace or all nodes as YAML, for param load.

    Without FILE it prints to standard output.
    """
    graph, client = look(timeout)
    file, nodes = _file_and_nodes(graph, words, output)
    answers, errors = client.get_all(nodes)
    none = "" if nodes else f"no node with parameters on {client.url}"
    if none and file not in (None, "-"):
        raise LcmtoolsError(none, f"{file} is left as it is")
    if as_json:
        write_document(report.all_values(answers))
    elif file in (None, "-"):
        write_lines(report.tree(answers))
    elif not errors:  # an incomplete file is worse than none
        text = "".join(f"{row}\n" for row in report.tree(answers))
        write_whole(Path(str(file)), text)
    if none:
        write_note(none)
    return complain_of(errors)


def _file_and_nodes(
    graph: Graph, words: Sequence[str], output: str | None
) -> tuple[str | None, Sequence[NodeInfo]]:
    """Return the file and the nodes. rosparam has the file first, ros2 has none."""
    files = [*([output] if output else []), *words[:-1]]
    if len(files) > 1:
        raise UsageError(
            "too many arguments: expected a file and a node", "see lcmtools param dump --help"
        )
    if not words:
        return output, living_nodes(graph, show_all=True)
    try:
        return files[0] if files else None, named(graph, words[-1]).nodes
    except LcmtoolsError:
        if files or not (words[0] == "-" or "." in words[0]):
            raise
        return words[0], living_nodes(graph, show_all=True)


@subcommand("load", timeout_option, asking_options)
@examples("param load gains.yaml", "param load gains.yaml /husky0/simple_controller")
@argument("words", metavar="FILE [NODE]", nargs=-1, required=True, completer="bus:nodes_after_file")
def load(words: tuple[str, ...], *, timeout: float) -> None:
    """Set parameters of running nodes from a YAML file, as param dump writes it.

    Files of rosparam and ros2 are accepted, too. With NODE, names without a node belong to it. The
    whole file is checked before anything is set; each node sets all of its parameters or none.
    """
    file, name = _file_and_node(words)
    found = read_leaves(_read(file), "standard input" if file == "-" else file)
    if not found:
        raise InvalidFile(f"{file} contains no parameters", "for example kp: 0.5")
    graph, client = look(timeout)
    node = require_parameters(find_node(graph, in_names(name))) if name else None
    nodes = [node] if node else [n for n in nodes_with_parameters(graph) if not n.stale]
    answers, errors = client.get_all(nodes)
    if node and errors:
        raise errors[0]
    for target, changes in changes_of(found, answers, node.name if node else None).items():
        make_changes(client, target, changes)
        write_note(f"{target}: {', '.join(changes)} set")


def _file_and_node(words: Sequence[str]) -> tuple[str, str | None]:
    """Return the file and the node. ros2 has the node first."""
    if len(words) > 2:  # noqa: PLR2004 - the two
        raise UsageError(
            "too many arguments: expected a file and a node", "see lcmtools param load --help"
        )
    first, second = words if len(words) > 1 else (words[0], None)
    is_file = [word == "-" or Path(word).exists() for word in words]
    return (second, first) if second and is_file == [False, True] else (first, second)


def _read(file: str) -> str:
    if file != "-":
        return read_text(Path(file))
    with os_errors_as("cannot read standard input", kind=InvalidFile):
        return sys.stdin.buffer.read(LARGEST).decode()
