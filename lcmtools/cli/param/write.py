"""``lcmtools param set`` and ``load``."""

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from lcmtools.cli.bus import in_names
from lcmtools.cli.declare import argument, examples, subcommand
from lcmtools.cli.options import looking_options
from lcmtools.cli.output import talk
from lcmtools.cli.param.read import look, timeout_option
from lcmtools.cli.words import CommandWithWords
from lcmtools.errors import InvalidFile, UsageError
from lcmtools.messages.documents import parse_values
from lcmtools.messages.setting import ANY, text_of
from lcmtools.observe.find import find_node
from lcmtools.publish.parameter_file import changes_of, make_changes, read_leaves
from lcmtools.publish.parameters import (
    ParameterClient,
    Target,
    find_target,
    nodes_with_parameters,
    require_parameters,
)

_EXAMPLE = "for example: lcmtools param set /husky0/simple_controller kp 0.5"


@subcommand("set", timeout_option, looking_options, cls=CommandWithWords)
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
        raise UsageError("there are more words than a value", "put the value in quotes")
    graph, client = look(timeout)
    target = find_target(graph, [in_names(words[0]), *words[1:-1]])
    texts = _texts(client, target, words[-1])
    parameters = client.request(target.node.name, texts)
    for name in texts:
        talk(f"{target.node.name}/{name} is now {parameters[name].text}")


def _texts(client: ParameterClient, target: Target, value: str) -> Mapping[str, str]:
    if target.parameter is not None:
        return {target.parameter: value}
    values = parse_values([value])
    if not isinstance(values, dict):
        raise UsageError(
            f"the parameter's name or its value is missing, for {target.node.name}", _EXAMPLE
        )
    known = client.request(target.node.name)
    kinds = {name: known[name].kind if name in known else ANY for name in values}
    return {name: text_of(part, kinds[name]) for name, part in values.items()}


@subcommand("load", timeout_option, looking_options)
@examples("param load gains.yaml", "param load gains.yaml /husky0/simple_controller")
@argument("words", metavar="FILE [NODE]", nargs=-1, required=True, completer="bus:nodes_after_file")
def load(words: tuple[str, ...], *, timeout: float) -> None:
    """Set parameters of running nodes from a YAML file, as param dump writes it.

    Files of rosparam and ros2 are accepted, too. With NODE, names without a node belong to it. The
    whole file is checked before anything is set; each node sets all of its parameters or none.
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
    if len(words) > 2:  # noqa: PLR2004 - the two
        raise UsageError("there is more than a file and a node", "see lcmtools param load --help")
    first, second = words if len(words) > 1 else (words[0], None)
    is_file = [word == "-" or Path(word).exists() for word in words]
    return (second, first) if second and is_file == [False, True] else (first, second)


def _read(file: str) -> str:
    source = "standard input" if file == "-" else file
    try:
        return (sys.stdin.buffer.read() if file == "-" else Path(file).read_bytes()).decode()
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not UTF-8 text"
        raise InvalidFile(f"cannot read {source}: {reason}") from error
