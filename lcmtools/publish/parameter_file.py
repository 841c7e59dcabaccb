"""Files of parameters, and the changes that they make.

Belongs here: YAML and JSON in the forms of rosparam (nested namespaces), ros2 (``ros__parameters``)
and ``lcmtools param dump``, compared with the nodes' parameters.
"""

import contextlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from lcmtools.errors import InvalidFile, LcmtoolsError, ValueMismatch
from lcmtools.formats.strict_json import write_json
from lcmtools.formats.strict_yaml import YamlNode, read_documents
from lcmtools.formats.yaml_problem import BadYaml
from lcmtools.messages.fill import Value
from lcmtools.messages.setting import read_setting, text_of
from lcmtools.names import did_you_mean
from lcmtools.publish.remote_parameters import (
    Answers,
    ParameterClient,
    Parameters,
    RefusedParameters,
    pick,
)

_EVERY_NODE = "/**"
_ROS2_KEY = "ros__parameters"

_Path: TypeAlias = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class FileParameter:
    """A value of a file, with the keys that lead to it, and the file and line for messages."""

    path: _Path
    value: Value
    place: str


@dataclass(frozen=True, slots=True)
class Change:
    """A parameter's new value as YAML, and the file and line that it comes from."""

    text: str
    place: str


Changes: TypeAlias = Mapping[str, Mapping[str, Change]]
"""New values by node and parameter."""


def read_leaves(text: str, source: str) -> list[FileParameter]:
    """Return the values in the text of a file; InvalidFile unless YAML of names and values."""
    found: list[FileParameter] = []
    for document in _documents(text, source):
        if not isinstance(document.value, dict):
            place = f"{source}:{document.line}"
            raise InvalidFile(f"{place}: expected names and values", "for example kp: 0.5")
        for path, node in _flat(document, ()):
            names = tuple(key for key in path if key != _ROS2_KEY)
            found.append(FileParameter(names, node.plain(), f"{source}:{node.key_line}"))
    return found


def known_name(path: Sequence[str], has: Parameters) -> str | None:
    """Return a nested parameter's name: written with slashes or, as in ros2, with dots."""
    return next((name for name in ("/".join(path), ".".join(path)) if name in has), None)


def changes_of(leaves: Sequence[FileParameter], known: Answers, node: str | None) -> Changes:
    """Return the changes that a file's values ask for; values without a node are for ``node``.

    Raises:
        LcmtoolsError: There is no such node or parameter; the error has file and line.
        InvalidFile: A value has another type than the parameter; the error has file and line.
    """
    changes: dict[str, dict[str, Change]] = {}
    for leaf in leaves:
        for target, rest in _targets(leaf, known, node):
            has = known[target]
            name = known_name(rest, has) or "/".join(rest)
            parameter = pick(has, name, target, f"{leaf.place}: ")
            text = text_of(leaf.value, parameter.type)
            try:
                read_setting(text, parameter.type, f"parameter {name}")
            except ValueMismatch as mismatch:
                raise InvalidFile(f"{leaf.place}: {mismatch.what}", mismatch.hint) from None
            changes.setdefault(target, {})[name] = Change(text, leaf.place)
    return changes


def make_changes(client: ParameterClient, node: str, changes: Mapping[str, Change]) -> None:
    """Change parameters of one node, all or none.

    Raises:
        LcmtoolsError: The node refuses; the error has the file and line of the refused value.
        ServiceError: It did not answer.
    """
    try:
        client.request(node, {name: change.text for name, change in changes.items()})
    except RefusedParameters as error:
        whole_file = next(iter(changes.values())).place.rpartition(":")[0]
        refused = (
            change.place
            for name, change in changes.items()
            for reason in error.reasons
            if reason.startswith((f"parameter {name}:", f"parameter {name} "))
        )
        raise LcmtoolsError(f"{next(refused, whole_file)}: {error.what}") from None


def _targets(leaf: FileParameter, known: Answers, node: str | None) -> list[tuple[str, _Path]]:
    """The nodes that a value is for, each with the rest of the value's path."""
    parts = tuple(part for key in leaf.path for part in key.split("/") if part)
    if leaf.path[0] == _EVERY_NODE:
        names = (n for n, has in known.items() if n == node or known_name(parts[1:], has))
        if having := [(name, parts[1:]) for name in names]:
            return having
    for end in range(len(parts), 0, -1):
        if (name := f"/{'/'.join(parts[:end])}") in known:
            return [(name, parts[end:])]
    if node is not None:
        return [(node, parts)]
    based = [n for n in known if n.rpartition("/")[2] == parts[0]] if len(parts) > 1 else []
    if len(based) == 1:
        return [(based[0], parts[1:])]
    if len(parts) < 2:  # noqa: PLR2004 - a node and a parameter
        what = f"{leaf.place}: '{'/'.join(parts)}' is for no node"
        raise LcmtoolsError(what, "write the node after the file")
    name = f"/{'/'.join(parts[:-1])}"
    hint = did_you_mean(name, known) or "lcmtools param list shows nodes and parameters"
    raise LcmtoolsError(f"{leaf.place}: there is no node {name}", hint)


def _documents(text: str, source: str) -> list[YamlNode]:
    try:
        return [node for node in read_documents(text) if node]
    except BadYaml as bad:
        with contextlib.suppress(ValueError, RecursionError, BadYaml):
            # JSON has escapes that YAML does not have
            return [node for node in read_documents(write_json(json.loads(text))) if node]
        raise InvalidFile(f"{source}:{bad.line or 1}: not YAML: {bad.problem}", bad.hint) from None


def _flat(node: YamlNode, path: _Path) -> Iterator[tuple[_Path, YamlNode]]:
    if isinstance(node.value, dict):
        for key, part in node.value.items():
            yield from _flat(part, (*path, key))
    else:
        yield path, node
