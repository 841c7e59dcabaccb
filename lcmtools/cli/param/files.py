"""``lcmtools param dump`` and ``load``."""

import sys
from collections.abc import Sequence
from pathlib import Path

from lcmtools.cli.bus import in_names
from lcmtools.cli.declare import argument, examples, option, subcommand
from lcmtools.cli.options import asking_options, json_option
from lcmtools.cli.output import write_document, write_lines, write_note
from lcmtools.cli.param.common import complain_of, living_nodes, look, named, timeout_option
from lcmtools.errors import InvalidFile, LcmtoolsError, UsageError, os_errors_as
from lcmtools.folders import LARGEST, read_text, write_whole
from lcmtools.graph.model import Graph, Node
from lcmtools.observe.reading.find import find_node
from lcmtools.publish import parameter_report as report
from lcmtools.publish.parameter_file import changes_of, make_changes, read_leaves
from lcmtools.publish.remote_parameters import nodes_with_parameters, require_parameters


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
    if as_json:
        write_document(report.all_values(answers))
    elif file in (None, "-"):
        write_lines(report.tree(answers))
    elif not errors:  # an incomplete file is worse than none
        text = "".join(f"{row}\n" for row in report.tree(answers))
        write_whole(Path(str(file)), text)
    return complain_of(errors)


def _file_and_nodes(
    graph: Graph, words: Sequence[str], output: str | None
) -> tuple[str | None, Sequence[Node]]:
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
