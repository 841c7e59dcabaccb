"""What ``lcmtools launch`` takes: files, packages and theirs, arguments, a file's nodes.

A file that is wrong has no candidates: whoever launches it is told.
"""

import os
from collections.abc import Iterator, Sequence

from lcmtools.cli.completion.candidate import FILES, Candidate
from lcmtools.cli.completion.situation import Situation
from lcmtools.errors import LcmtoolsError
from lcmtools.launch.file import File, read_file
from lcmtools.launch.packages import find_files, lab_files, launch_files

_NAMESPACE = "__ns:="


def words(situation: Situation) -> Iterator[Candidate]:
    """The next of the words after ``lcmtools launch``."""
    given = situation.given.get("words", ())
    places = [word for word in given if ":=" not in word]
    if situation.word.startswith(_NAMESPACE):
        yield from _namespaces(situation)
    elif not places:
        yield from (Candidate(name, package) for package, name in lab_files())
        yield FILES
    else:
        if len(places) == 1:
            yield from (Candidate(name) for name in launch_files(places[0]))
        yield from _arguments(_read(places), given)


def nodes(situation: Situation) -> Iterator[Candidate]:
    """The nodes of the file that is given."""
    from lcmtools.cli.launch.typed import read_words
    from lcmtools.launch.reading import Given, make_plan

    try:
        typed = read_words(situation.given.get("words", ()), None, situation.namespace)
        given = Given(typed.arguments, typed.namespace, os.environ)
        plan = make_plan(_read(typed.places), given)
    except LcmtoolsError:
        return
    yield from (Candidate(node.name, node.place) for node in plan.nodes)


def _arguments(files: Sequence[File], given: Sequence[str]) -> Iterator[Candidate]:
    from lcmtools.launch.arguments import arguments_of

    said = {word.partition(":=")[0] for word in given}
    for file in files:
        for argument in arguments_of(file.root):
            if argument.name not in said:
                yield Candidate(f"{argument.name}:=", argument.doc, is_open=True)
    if "__ns" not in said:
        yield Candidate(_NAMESPACE, "the namespace of all of it", is_open=True)


def _namespaces(situation: Situation) -> Iterator[Candidate]:
    from lcmtools.cli.completion.words.nodes import namespaces

    for one in namespaces(situation.at(situation.word.removeprefix(_NAMESPACE))):
        yield Candidate(f"{_NAMESPACE}{one.value}")


def _read(places: Sequence[str]) -> list[File]:
    try:
        return [read_file(path) for path in find_files(places)]
    except LcmtoolsError:
        return []
