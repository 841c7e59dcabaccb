"""The rules of ``lcmtools wtf``; they are read together with the command, and kept."""

from collections.abc import Iterator

from lcmtools.cli.completion.candidate import Candidate
from lcmtools.cli.completion.situation import Situation


def rules(situation: Situation) -> Iterator[Candidate]:
    """The rules by their ids."""
    del situation
    from lcmtools.doctor.rules import RULES

    yield from (Candidate(rule.id, rule.title) for rule in RULES)
