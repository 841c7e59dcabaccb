"""Which kind of word an argument or an option's value is, and where its candidates come from.

A command gets completion by calling its parameter what others call it: ``topic``, ``node``,
``type_``. A new kind is a line here and a function in a file beside.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from importlib import import_module
from typing import TYPE_CHECKING, cast

from lcmtools.cli.completion.candidate import FILES, Candidate
from lcmtools.cli.completion.situation import Situation

if TYPE_CHECKING:  # only who reads the commands needs click
    import click

Kind = Callable[[Situation], Iterable[Candidate]]

_CHOICE = "one of "
_FILE = "file"

_BY_PARAMETER: Mapping[str, str] = {
    "topic": "topic",
    "topics": "topic",
    "type_": "type",
    "types": "type",
    "type_name": "type",
    "node": "node",
    "nodes": "node",
    "service": "service",
    "services": "service",
    "service_type": "service_type",
    "parameter": "parameter",
    "parameters": "parameter",
    "target": "parameter",
    "namespace": "namespace",
    "ns": "namespace",
    "package": "package",
    "dependencies": "package",
    "host": "host",
    "values": "message",
    "field": "field",
    "fields": "field",
    "remap": "remap",
    "lcm_url": "bus",
    "file": _FILE,
    "files": _FILE,
}
"""By the parameter's name."""

_BY_COMMAND: Mapping[str, str] = {
    "echo topic": "topic_and_field",
    "echo words": "topic_and_field",
    "help words": "command",
    "launch words": "launch",
    "launch node": "launched_node",
    "pkg build name": "workspace_package",
    "pkg find name": "workspace_package",
    "pkg prefix name": "workspace_package",
    "run name": "program",
    "run arguments": "program_argument",
    "srv show type_": "service_type",
    "service find type_": "service_type",
    "service call words": "request",
    "param get node": "parameter",
    "param get name": "parameter",
    "param describe node": "parameter",
    "param describe name": "parameter",
    "param set words": "parameter",
    "param dump words": _FILE,
    "param load words": _FILE,
    "completion shell": _CHOICE + "bash zsh fish",
}
"""Where a name means something else: the command's last words and the parameter's name."""

_HOMES: Mapping[str, str] = {
    "topic": "topics:topics",
    "topic_and_field": "topics:topics_and_fields",
    "field": "fields:fields",
    "type": "types:types",
    "service_type": "types:service_types",
    "package": "types:packages",
    "message": "prototypes:messages",
    "request": "prototypes:requests",
    "node": "nodes:nodes",
    "host": "nodes:hosts",
    "namespace": "nodes:namespaces",
    "service": "services:services",
    "parameter": "parameters:parameters",
    "launch": "launches:words",
    "launched_node": "launches:nodes",
    "program": "programs:programs",
    "workspace_package": "programs:packages",
    "program_argument": "programs:arguments",
    "remap": "programs:remaps",
    "bus": "buses:buses",
    "command": "commands:commands",
}
"""By the kind: where its candidates come from, in this package."""


def kind_of(parameter: "click.Parameter", path: Sequence[str]) -> str:
    """What a parameter of the command with these words is; "" where nothing is known of it."""
    import click

    if isinstance(parameter.type, click.Choice):
        return _CHOICE + " ".join(map(str, parameter.type.choices))
    words = " ".join((*path, str(parameter.name)))
    for special, kind in _BY_COMMAND.items():
        if f" {words}".endswith(f" {special}"):
            return kind
    if isinstance(parameter.type, (click.Path, click.File)):
        return _FILE
    return _BY_PARAMETER.get(str(parameter.name), "")


def candidates(kind: str, situation: Situation) -> list[Candidate]:
    """The words of a kind that could stand in a situation; none of a kind that is not known."""
    if kind == _FILE:
        return [FILES]
    if kind.startswith(_CHOICE):
        return [Candidate(word) for word in kind.removeprefix(_CHOICE).split()]
    if kind not in _HOMES:
        return []
    module, _, function = _HOMES[kind].partition(":")
    home = import_module(f"lcmtools.cli.completion.words.{module}")
    return list(cast(Kind, getattr(home, function))(situation))
