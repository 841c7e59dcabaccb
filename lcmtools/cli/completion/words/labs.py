"""The labs, what a student starts from, and what a lab's simulator takes."""

from collections.abc import Iterator
from dataclasses import replace

from lcmtools.cli.completion.candidate import Candidate
from lcmtools.cli.completion.situation import Situation


def labs(situation: Situation) -> Iterator[Candidate]:
    """The labs by name."""
    del situation
    from lcmtools.labs.catalogue import LABS

    yield from (Candidate(lab.name, lab.title) for lab in LABS.values())


def skeletons(situation: Situation) -> Iterator[Candidate]:
    """The nodes that are there to be filled in."""
    del situation
    from lcmtools.labs.skeletons import NAMES

    yield from map(Candidate, NAMES)


def simulator_arguments(situation: Situation) -> Iterator[Candidate]:
    """The simulator's own arguments; which world it is, the lab says."""
    from lcmtools.cli.completion.words.programs import arguments

    before = ("--world", situation.value("name"), *situation.given.get("arguments", ()))
    given = {**situation.given, "name": ("sim",), "arguments": before}
    yield from arguments(replace(situation, given=given))
