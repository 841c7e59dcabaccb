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
_LISTED = "listed\n"
"""Before words and what they are, that were read together with the command: a line for each."""
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
    "robot": "robot",
    "lcm_url": "bus",
    "file": _FILE,
    "files": _FILE,
}
"""By the parameter's name."""

_BY_METAVAR: Mapping[str, str] = {
    "COMMAND": _FILE,
    "FILE": _FILE,
    "NODE": "node",
}
"""By what help calls it, where the parameter's name says nothing."""

_BY_COMMAND: Mapping[str, str] = {
    "echo topic": "topic_and_field",
    "echo words": "topic_and_field",
    "graph excluded": "name",
    "graph namespace": "name",
    "help words": "command",
    "lab check name": "lab",
    "lab skeleton name": "skeleton",
    "lab start arguments": "simulator_argument",
    "lab start name": "lab",
    "launch words": "launch",
    "launch node": "launched_node",
    "launch sought": "launched_node",
    "pkg build name": "workspace_package",
    "pkg create license_": _CHOICE + "Apache-2.0 BSD-3-Clause GPL-3.0-only LGPL-2.1-only MIT",
    "pkg create node": "",
    "pkg find name": "workspace_package",
    "pkg prefix name": "workspace_package",
    "run name": "program",
    "run arguments": "program_argument",
    "sim spawn model": _CHOICE + "dolly husky pioneer",
    "sim spawn robot": "",
    "spy topics": "name",
    "srv show type_": "service_type",
    "service find type_": "service_type",
    "service call words": "request",
    "param get node": "parameter",
    "param get name": "parameter",
    "param describe node": "parameter",
    "param describe name": "parameter",
    "param set words": "parameter",
    "param dump words": "node_or_file",
    "param load words": "file_then_node",
    "completion shell": _CHOICE + "bash zsh fish",
    **dict.fromkeys(
        (
            f"{name} {option}"
            for name in ("wtf", "doctor")
            for option in ("only", "ignore", "explain")
        ),
        "rule",
    ),
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
    "name": "nodes:names",
    "robot": "robots:robots",
    "node_or_file": "nodes:nodes_and_files",
    "file_then_node": "nodes:nodes_behind_a_file",
    "service": "services:services",
    "parameter": "parameters:parameters",
    "launch": "launches:words",
    "launched_node": "launches:nodes",
    "program": "programs:programs",
    "workspace_package": "programs:packages",
    "program_argument": "programs:arguments",
    "lab": "labs:labs",
    "skeleton": "labs:skeletons",
    "simulator_argument": "labs:simulator_arguments",
    "remap": "programs:remaps",
    "bus": "buses:buses",
    "command": "commands:commands",
}
"""By the kind: where its candidates come from, in this package."""


_KEPT: Mapping[str, str] = {"rule": "rules:rules"}
"""By the kind: where its words come from that are read only together with the command.

For words that change with the code only, and whose module is slow to import.
"""


def kind_of(parameter: "click.Parameter", path: Sequence[str]) -> str:
    """What a parameter of the command with these words is; "" where nothing is known of it."""
    import click

    if isinstance(parameter.type, click.Choice):
        return _CHOICE + " ".join(map(str, parameter.type.choices))
    words = " ".join((*path, str(parameter.name)))
    for special, kind in _BY_COMMAND.items():
        if f" {words}".endswith(f" {special}"):
            return _listed(kind) if kind in _KEPT else kind
    if isinstance(parameter.type, (click.Path, click.File)):
        return _FILE
    usual = _BY_METAVAR.get(parameter.metavar or "", "")
    return _BY_PARAMETER.get(str(parameter.name), usual)


def _listed(kind: str) -> str:
    """The words of a kind, each with what it is, as a kind of their own."""
    found = _home(_KEPT[kind])(Situation((), ""))
    return _LISTED + "\n".join(f"{one.value}\t{one.help}" for one in found)


def candidates(kind: str, situation: Situation) -> list[Candidate]:
    """The words of a kind that could stand in a situation; none of a kind that is not known."""
    if kind == _FILE:
        return [FILES]
    if kind.startswith(_CHOICE):
        return [Candidate(word) for word in kind.removeprefix(_CHOICE).split()]
    if kind.startswith(_LISTED):
        pairs = (line.partition("\t") for line in kind.removeprefix(_LISTED).splitlines())
        return [Candidate(word, text) for word, _, text in pairs]
    return list(_home(_HOMES[kind])(situation)) if kind in _HOMES else []


def _home(place: str) -> Kind:
    """The function that knows the words of a kind."""
    module, _, function = place.partition(":")
    home = import_module(f"lcmtools.cli.completion.words.{module}")
    return cast(Kind, getattr(home, function))
