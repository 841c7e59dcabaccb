"""``lcmtools param dump``."""

import contextlib
from collections.abc import Sequence
from pathlib import Path

from lcmtools.cli.declare import argument, option, subcommand
from lcmtools.cli.options import in_names, json_option, looking_options
from lcmtools.cli.output import document, lines
from lcmtools.cli.param.common import (
    complain_of,
    json_values,
    living_nodes,
    look,
    timeout_option,
    tree,
)
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.graph.model import Graph, Node
from lcmtools.publish.parameters import find_target

_MOST_WORDS = 2


@subcommand("dump")
@argument("words", metavar="[FILE] [NODE]", nargs=-1, completer="bus:nodes_and_files")
@option("-o", "--output", metavar="FILE", help="Write into this file.", completer="files")
@timeout_option
@json_option
@looking_options
def command(words: tuple[str, ...], *, output: str | None, timeout: float, as_json: bool) -> int:
    """Write the parameters of a node, a namespace or all nodes as YAML, for param load.

    Without a FILE it goes to standard output.

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
