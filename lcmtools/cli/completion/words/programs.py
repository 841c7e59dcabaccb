"""What ``lcmtools run`` takes: nodes that can be run, their arguments, remaps.

A node that takes words of its own completes them by a module ``completion`` in its package, with a
function ``complete(before, word)`` that gives words; ``before`` are the arguments before it.
"""

from collections.abc import Iterable, Iterator, Sequence
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pathlib import Path
from typing import Protocol, cast

from lcmtools.cli.completion.candidate import FILES, Candidate
from lcmtools.cli.completion.situation import Situation
from lcmtools.names import base_name_of, is_hidden
from lcmtools.packages.nodes import OWN, runnables
from lcmtools.packages.workspace import workspace

_GROUP = "lcmtools.nodes"
_FLAGS = {
    "--ns": "namespace",
    "--name": "",
    "--param": "",
    "--remap": "remap",
    "-r": "remap",
    "--lcm-url": "bus",
    "--domain": "",
}
"""What every node takes besides (see lcmtools.arguments), and what its value is."""


class Completer(Protocol):
    """What a node's package may have: words for the node's own arguments."""

    def __call__(self, before: Sequence[str], word: str) -> Iterable[str]:
        """The words that could stand behind ``before``."""
        ...


def programs(situation: Situation) -> Iterator[Candidate]:
    """The nodes that can be run, and the packages of others than lcmtools' own."""
    del situation
    known = runnables(Path.cwd())
    yield from (Candidate(node.name) for node in known if node.package == OWN)
    yield from map(Candidate, dict.fromkeys(one.package for one in known if one.package != OWN))


def packages(situation: Situation) -> Iterator[Candidate]:
    """The packages of the workspace."""
    del situation
    yield from (Candidate(package.name) for package in workspace(Path.cwd()).packages)


def arguments(situation: Situation) -> Iterator[Candidate]:
    """A node's arguments: those that every node takes, and its own."""
    before = list(situation.given.get("arguments", ()))
    if not before:
        package = situation.value("name")
        known = [one for one in runnables(Path.cwd()) if one.package == package]
        yield from (Candidate(node.name) for node in known)
        if known and package not in {node.name for node in known}:
            return
    flag_before = before[-1] if before else ""
    if flag_before in _FLAGS:
        yield from _values(situation, _FLAGS[flag_before])
        return
    flag, equals, _ = situation.word.partition("=")
    if flag in _FLAGS and equals:
        yield from _values(situation, _FLAGS[flag], f"{flag}=")
        return
    own = list(_own(situation, before))
    yield from own
    if situation.word.startswith("-"):
        yield from map(Candidate, _FLAGS)
    elif not (own and flag_before.startswith("-")):
        yield from remaps(situation)


def remaps(situation: Situation) -> Iterator[Candidate]:
    """``__ns:=``, ``__name:=`` and names on the bus with ``:=``; behind that what may follow."""
    name, mark, _ = situation.word.partition(":=")
    if mark:
        kind = "namespace" if name == "__ns" else "" if name.startswith("_") else "topic"
        yield from _values(situation, kind, f"{name}:=")
        return
    if not situation.word or situation.word.startswith("_"):
        yield from (Candidate(f"{name}:=", is_open=True) for name in ("__ns", "__name"))
        return
    for topic in situation.graph.topic_names():
        if not is_hidden(topic):
            full = situation.word.startswith("/")
            yield Candidate(f"{topic if full else base_name_of(topic)}:=", is_open=True)


def _values(situation: Situation, kind: str, before: str = "") -> Iterator[Candidate]:
    """Candidates of a kind for the part of the word behind ``before``."""
    from lcmtools.cli.completion.words.table import candidates

    inner = situation.at(situation.word.removeprefix(before))
    for one in candidates(kind, inner):
        yield Candidate(f"{before}{one.value}", one.help, one.is_open)


def _own(situation: Situation, before: Sequence[str]) -> Iterator[Candidate]:
    """What the node's own package says."""
    name = situation.value("name")
    for entry in entry_points(group=_GROUP, name=name):
        complete = _completer(entry)
        if complete:
            for word in complete(before, situation.word):
                yield Candidate(word, is_open=word.endswith("=")) if word else FILES


def _completer(entry: EntryPoint) -> Completer | None:
    module = f"{entry.module.rpartition('.')[0]}.completion"
    try:
        if find_spec(module) is None:
            return None
    except (ImportError, ValueError):
        return None
    return cast(Completer, import_module(module).complete)
