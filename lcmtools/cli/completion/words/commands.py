"""Commands, as the words that ``lcmtools help`` takes."""

from collections.abc import Iterator

from lcmtools.cli.completion.candidate import Candidate
from lcmtools.cli.completion.situation import Situation
from lcmtools.cli.completion.tree import Tree


def commands(situation: Situation) -> Iterator[Candidate]:
    """The commands of the group whose words stand before."""
    group = Tree(situation.environment).describe(situation.given.get("words", ()))
    if group is not None:
        yield from (Candidate(name, text) for name, text in group.commands.items())
