"""Completers of the labs' commands: labs, skeletons, a lab's simulator's arguments."""

from collections.abc import Iterator

from lcmtools.cli.completion.situation import Candidate, Situation


def labs(_: Situation) -> Iterator[Candidate]:
    """Complete the names of the labs."""
    from lcmtools.labs.catalogue import LABS

    yield from (Candidate(lab.name, lab.title) for lab in LABS.values())


def skeletons(_: Situation) -> Iterator[Candidate]:
    """Complete the names of the skeletons."""
    from lcmtools.labs.skeletons import NAMES

    yield from map(Candidate, NAMES)


def simulator_arguments(situation: Situation) -> Iterator[Candidate]:
    """Complete the simulator's arguments, except for the world, which the lab defines."""
    from lcmtools.cli.completion.runnables import arguments

    before = ("--world", situation.last("name"), *situation.all("arguments"))
    given = {**situation.given, "name": ("sim",), "arguments": before}
    yield from arguments(Situation(situation.word, given, situation.environment))
