"""``lcmtools param load``."""

import sys
from collections.abc import Sequence
from pathlib import Path

from lcmtools.cli.declare import argument, subcommand
from lcmtools.cli.options import in_names, looking_options
from lcmtools.cli.output import talk
from lcmtools.cli.param.common import look, timeout_option
from lcmtools.errors import InvalidFile, UsageError
from lcmtools.observe.find import find_node
from lcmtools.publish.parameter_file import changes_of, make_changes, read_leaves
from lcmtools.publish.parameters import nodes_with_parameters, require_parameters

_MOST_WORDS = 2


@subcommand("load")
@argument("words", metavar="FILE [NODE]", nargs=-1, required=True, completer="bus:nodes_after_file")
@timeout_option
@looking_options
def command(words: tuple[str, ...], *, timeout: float) -> None:
    """Set parameters of nodes that run from a YAML file, as param dump writes it.

    The files of rosparam and ros2 are taken too. With NODE, names without a node are that node's.
    Everything is checked before anything is set; a node sets all that is for it, or nothing.

    \b
    Examples:
      lcmtools param load gains.yaml
      lcmtools param load gains.yaml /husky0/simple_controller
    """
    file, name = _meant(words)
    found = read_leaves(_read(file), "standard input" if file == "-" else file)
    if not found:
        raise InvalidFile(f"{file} has no parameter in it", "for example kp: 0.5")
    graph, client = look(timeout)
    node = require_parameters(find_node(graph, in_names(name))) if name else None
    nodes = [node] if node else [n for n in nodes_with_parameters(graph) if not n.stale]
    answers, errors = client.get_all(nodes)
    if node and errors:
        raise errors[0]
    for target, changes in changes_of(found, answers, node.name if node else None).items():
        make_changes(client, target, changes)
        talk(f"{target}: {', '.join(changes)} set")


def _meant(words: Sequence[str]) -> tuple[str, str | None]:
    """The file and the node; ros2 writes the node first."""
    if len(words) > _MOST_WORDS:
        raise UsageError("there is more than a file and a node", "see lcmtools param load --help")
    if len(words) == 1:
        return words[0], None
    first, second = words
    if first != "-" and not Path(first).exists() and (second == "-" or Path(second).exists()):
        return second, first
    return first, second


def _read(file: str) -> str:
    source = "standard input" if file == "-" else file
    try:
        return (sys.stdin.buffer.read() if file == "-" else Path(file).read_bytes()).decode()
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not UTF-8 text"
        raise InvalidFile(f"cannot read {source}: {reason}") from error
