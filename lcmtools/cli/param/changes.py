"""What a file of parameters changes, by node: checked against the parameters that there are."""

from collections.abc import Sequence
from dataclasses import dataclass

from lcmtools.cli.param.ask import Answers
from lcmtools.cli.param.file import Leaf
from lcmtools.errors import InvalidFile, LcmtoolsError, ValueMismatch
from lcmtools.messages.setting import read_setting, text_of
from lcmtools.names import did_you_mean
from lcmtools.node.remote import RemoteParameter


@dataclass(frozen=True, slots=True)
class Change:
    """A new value.

    Attributes:
        text: The value as YAML.
        place: File and line that it comes from.
    """

    text: str
    place: str


Changes = dict[str, dict[str, Change]]
"""New values by node and parameter."""

_EVERY_NODE = "/**"


@dataclass(frozen=True, slots=True)
class _Place:
    """A node and what of a leaf's path is below it."""

    node: str
    rest: tuple[str, ...]


def changes_of(leaves: Sequence[Leaf], known: Answers, node: str | None) -> Changes:
    """The changes that a file's values mean.

    Args:
        leaves: The values.
        known: The parameters of the nodes that may be meant.
        node: The node that names without one are meant for; None for none.

    Raises:
        LcmtoolsError: There is no such node or parameter; with file and line.
        InvalidFile: A value is of another type than the parameter; with file and line.
    """
    changes: Changes = {}
    for leaf in leaves:
        for place in _places(leaf, known, node):
            parameter = _parameter(leaf, place, known)
            change = Change(_text(leaf, parameter), leaf.place)
            changes.setdefault(place.node, {})[parameter.name] = change
    return changes


def _places(leaf: Leaf, known: Answers, node: str | None) -> list[_Place]:
    parts = tuple(part for key in leaf.path for part in key.split("/") if part)
    if leaf.path[0] == _EVERY_NODE:
        rest = parts[1:]
        having = [n for n, has in known.items() if node == n or _found(rest, has)]
        if having:
            return [_Place(name, rest) for name in having]
    for end in range(len(parts), 0, -1):
        named = [n for n in known if n == f"/{'/'.join(parts[:end])}"]
        if named:
            return [_Place(named[0], parts[end:])]
    if node is not None:
        return [_Place(node, parts)]
    based = [n for n in known if n.rpartition("/")[2] == parts[0]] if len(parts) > 1 else []
    if len(based) == 1:
        return [_Place(based[0], parts[1:])]
    raise _no_node(leaf, parts, known)


def _no_node(leaf: Leaf, parts: tuple[str, ...], known: Answers) -> LcmtoolsError:
    if len(parts) < 2:  # noqa: PLR2004 - a node and a parameter
        return LcmtoolsError(
            f"{leaf.place}: '{'/'.join(parts)}' is for no node", "write the node after the file"
        )
    name = f"/{'/'.join(parts[:-1])}"
    hint = did_you_mean(name, known) or "lcmtools param list shows nodes and parameters"
    return LcmtoolsError(f"{leaf.place}: there is no node {name}", hint)


def _parameter(leaf: Leaf, place: _Place, known: Answers) -> RemoteParameter:
    has = known[place.node]
    found = _found(place.rest, has)
    if found is None:
        name = "/".join(place.rest)
        hint = did_you_mean(name, has) or f"it has {', '.join(has)}"
        raise LcmtoolsError(f"{leaf.place}: {place.node} has no parameter '{name}'", hint)
    return has[found]


def _found(rest: tuple[str, ...], has: dict[str, RemoteParameter]) -> str | None:
    """The parameter's name: nested names are written with slashes or, as in ROS 2, with dots."""
    return next((name for name in ("/".join(rest), ".".join(rest)) if name in has), None)


def _text(leaf: Leaf, parameter: RemoteParameter) -> str:
    text = text_of(leaf.value, parameter.kind)
    try:
        read_setting(text, parameter.kind, f"parameter {parameter.name}")
    except ValueMismatch as mismatch:
        raise InvalidFile(f"{leaf.place}: {mismatch.what}", mismatch.hint) from None
    return text
