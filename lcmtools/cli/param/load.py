"""``lcmtools param load``."""

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import click

from lcmtools.cli.completion.completer import complete
from lcmtools.cli.options import CONTEXT, bus_options
from lcmtools.cli.output import talk
from lcmtools.cli.param.ask import Asker, look, timeout_option
from lcmtools.cli.param.changes import Change, changes_of
from lcmtools.cli.param.file import leaves
from lcmtools.cli.param.target import require_parameters, with_parameters
from lcmtools.errors import InvalidFile, LcmtoolsError, UsageError
from lcmtools.node.remote import RefusedParameters
from lcmtools.observe.find import find_node

_MOST_WORDS = 2


@click.command("load", context_settings=CONTEXT)
@click.argument(
    "words",
    metavar="FILE [NODE]",
    nargs=-1,
    required=True,
    shell_complete=complete("bus:nodes_after_file"),
)
@timeout_option
@bus_options
def command(words: tuple[str, ...], *, timeout: float) -> None:
    """Set parameters of nodes that run from a YAML file, as param dump writes it.

    The files of rosparam and ros2 are taken too. With NODE, names without a node are that node's.
    Everything is checked before anything is set; a node sets all that is for it, or nothing.

    \b
    Examples:
      lcmtools param load gains.yaml
      lcmtools param load gains.yaml /husky0/simple_controller
    """  # noqa: D301 - \b is click's mark
    file, name = _meant(words)
    found = leaves(_read(file), "standard input" if file == "-" else file)
    if not found:
        raise InvalidFile(f"{file} has no parameter in it", "for example kp: 0.5")
    asker = look(timeout)
    node = require_parameters(find_node(asker.graph, name)) if name else None
    nodes = [node] if node else [n for n in with_parameters(asker.graph) if not n.stale]
    answers, errors = asker.ask(nodes) if nodes else ({}, [])
    if node and errors:
        raise errors[0]
    for target, changes in changes_of(found, answers, node.name if node else None).items():
        _set(asker, target, changes)
        talk(f"{target}: {', '.join(changes)} set")


def _set(asker: Asker, node: str, changes: Mapping[str, Change]) -> None:
    """Change parameters of one node, all or none.

    Raises:
        LcmtoolsError: The node refuses; with the file and line of what it refuses.
    """
    try:
        asker.set(find_node(asker.graph, node), {name: c.text for name, c in changes.items()})
    except RefusedParameters as error:
        places = [
            change.place
            for name, change in changes.items()
            if any(
                reason.startswith((f"parameter {name}:", f"parameter {name} "))
                for reason in error.reasons
            )
        ]
        raise LcmtoolsError(f"{(places or [_file_of(changes)])[0]}: {error.what}") from None


def _file_of(changes: Mapping[str, Change]) -> str:
    return next(iter(changes.values())).place.rpartition(":")[0]


def _meant(words: Sequence[str]) -> tuple[str, str | None]:
    """The file and the node; ros2 writes the node first.

    Raises:
        UsageError: There are too many words.
    """
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
