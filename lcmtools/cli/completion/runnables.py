"""Completers for things to run and files of this computer: nodes, packages, launch files, commands.

A node that takes words of its own completes them by a module ``completion`` in its package, with a
function ``complete(before, word)`` that gives words; ``before`` are the arguments before it.
"""

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, cast

from lcmtools.cli.completion.situation import FILES, Candidate, Situation, candidates
from lcmtools.errors import LcmtoolsError
from lcmtools.names import base_name_of, is_hidden
from lcmtools.packages.programs import program_folder, programs_in
from lcmtools.packages.ros_packages import ros_packages
from lcmtools.packages.runnable_nodes import OWN, runnables
from lcmtools.packages.workspace import workspace

if TYPE_CHECKING:  # launch files are completed by lcmtools launch alone
    from lcmtools.launch.file import File

_GROUP = "lcmtools.nodes"
_NAMESPACE = "__ns:="
_FLAGS = {
    "--ns": "bus:namespaces",
    "--name": "",
    "--param": "",
    "--remap": "runnables:remaps",
    "-r": "runnables:remaps",
    "--lcm-url": "bus:urls",
    "--domain": "",
}
"""The flags of every node (see lcmtools.arguments), and the completers of their values."""


def programs(situation: Situation) -> Iterator[Candidate]:
    """Complete runnable nodes, packages that are not lcmtools' own, and Python files."""
    if "/" in situation.word:
        yield FILES
        return
    known = runnables(Path.cwd())
    yield from (Candidate(node.name) for node in known if node.package == OWN)
    homes = [one.package for one in known if one.package != OWN]
    own = (one.name for one in workspace(Path.cwd()).packages)
    yield from map(Candidate, dict.fromkeys((*homes, *own, *ros_packages(Path.cwd()))))
    yield from (Candidate(path.name) for path in sorted(Path().glob("*.py")))


def packages(_: Situation) -> Iterator[Candidate]:
    """Complete the packages of the workspace."""
    yield from (Candidate(package.name) for package in workspace(Path.cwd()).packages)


def arguments(situation: Situation) -> Iterator[Candidate]:
    """Complete a node's arguments: the common ones, and its own."""
    before = situation.all("arguments")
    if not before:
        package = situation.last("name")
        known = [one.name for one in runnables(Path.cwd()) if one.package == package]
        folder = program_folder(package, Path.cwd()) if "/" not in package else None
        known += [path.name for path in programs_in(folder)] if folder else []
        yield from map(Candidate, dict.fromkeys(known))
        if known and package not in known:
            return
    flag_before = before[-1] if before else ""
    if flag_before in _FLAGS:
        yield from _values(situation, _FLAGS[flag_before])
        return
    flag, equals, _ = situation.word.partition("=")
    if flag in _FLAGS and equals:
        yield from _values(situation, _FLAGS[flag], f"{flag}=")
        return
    own = list(_own_arguments(situation, before))
    yield from own
    if situation.word.startswith("-"):
        yield from map(Candidate, _FLAGS)
    elif not (own and flag_before.startswith("-")):
        yield from remaps(situation)


def remaps(situation: Situation) -> Iterator[Candidate]:
    """Complete ``__ns:=``, ``__name:=``, names on the bus with ``:=``, and their values."""
    name, mark, _ = situation.word.partition(":=")
    if mark:
        source = "bus:namespaces" if name == "__ns" else "" if name[:1] == "_" else "bus:topics"
        yield from _values(situation, source, f"{name}:=")
    elif not situation.word or situation.word.startswith("_"):
        yield from (Candidate(f"{name}:=", is_open=True) for name in ("__ns", "__name"))
    else:
        for topic in situation.graph.topic_names():
            if not is_hidden(topic):
                shown = topic if situation.is_global else base_name_of(topic)
                yield Candidate(f"{shown}:=", is_open=True)


def launch_words(situation: Situation) -> Iterator[Candidate]:
    """Complete a word of ``lcmtools launch``: a file, a package and its file, or an argument."""
    from lcmtools.launch.packages import lab_files, launch_files

    given = situation.all("words")
    places = [word for word in given if ":=" not in word]
    if situation.word.startswith(_NAMESPACE):
        yield from _values(situation, "bus:namespaces", _NAMESPACE)
    elif not places:
        yield from packages(situation)
        yield from (Candidate(name, package) for package, name in lab_files())
        yield FILES
    else:
        if len(places) == 1:
            yield from (Candidate(name) for name in launch_files(places[0]))
        yield from _launch_arguments(_launch_files(places), given)


def launched_nodes(situation: Situation) -> Iterator[Candidate]:
    """Complete the nodes of the launch file before the cursor, if it is valid."""
    from lcmtools.launch.file import read_words
    from lcmtools.launch.reading import make_plan

    try:
        typed = read_words(situation.all("words"), None, situation.namespace)
        files = _launch_files(typed.places)
        plan = make_plan(files, typed.arguments, typed.namespace, os.environ)
    except LcmtoolsError:
        return
    yield from (Candidate(node.name, node.place) for node in plan.nodes)


def commands(situation: Situation) -> Iterator[Candidate]:
    """Complete the commands of the group before the cursor, for ``lcmtools help``."""
    from lcmtools.cli.completion.tree import describe

    group = describe(situation.all("words"))
    if group is not None:
        yield from (Candidate(name, text) for name, text in group.commands.items())


def _values(situation: Situation, source: str, before: str = "") -> Iterator[Candidate]:
    """Return the candidates of a source for the part of the word after ``before``."""
    for one in candidates(source, situation.at(situation.word.removeprefix(before))):
        yield Candidate(f"{before}{one.value}", one.help, one.is_open)


def _own_arguments(situation: Situation, before: Sequence[str]) -> Iterator[Candidate]:
    for entry in entry_points(group=_GROUP, name=situation.last("name")):
        if complete := _package_completer(entry):
            for word in complete(before, situation.word):
                yield Candidate(word, is_open=word.endswith("=")) if word else FILES


def _package_completer(entry: EntryPoint) -> Callable[[Sequence[str], str], Iterable[str]] | None:
    module = f"{entry.module.rpartition('.')[0]}.completion"
    try:
        if find_spec(module) is None:
            return None
    except (ImportError, ValueError):
        return None
    complete = import_module(module).complete
    return cast(Callable[[Sequence[str], str], Iterable[str]], complete)


def _launch_files(places: Sequence[str]) -> "list[File]":
    from lcmtools.launch.file import read_file
    from lcmtools.launch.packages import find_files

    try:
        return [read_file(path) for path in find_files(places)]
    except LcmtoolsError:
        return []


def _launch_arguments(files: "Sequence[File]", given: Sequence[str]) -> Iterator[Candidate]:
    from lcmtools.launch.arguments import arguments_of

    known = {word.partition(":=")[0] for word in given}
    for file in files:
        for argument in arguments_of(file.root):
            if argument.name not in known:
                yield Candidate(f"{argument.name}:=", argument.doc, is_open=True)
    if "__ns" not in known:
        yield Candidate(_NAMESPACE, "the namespace of all of it", is_open=True)
