"""The option -1 of ``pub`` beside values, which may be -1 too."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import click

from lcmtools.cli.dashes import Dashes
from lcmtools.cli.words import CommandWithWords

_EXCLUDE_ONE = frozenset(("-r", "--rate", "-t", "--times"))
"""Options that the option -1 cannot stand beside."""
_ONE_VALUE = 3  # words: TOPIC, TYPE and the value
_ENDS_IN_ONE = f"{__name__}.ends_in_one"


class CommandWithValues(CommandWithWords):
    """A command with the option -1: the first -1 is the option, as in "rostopic pub -1".

    It is a value where the option cannot be meant: "-r 5 /speed std_msgs/Int32 -1".
    """

    dashes = Dashes(but="-1[a-z]+")  # "-1v" is two options

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the command line, whose argument "values" takes what is no option."""
        ctx.meta[_ENDS_IN_ONE] = args.count("-1") == 1 and args[-1] == "-1"
        return super().parse_args(ctx, args)

    def shielded(self, words: Sequence[str]) -> Iterator[str]:
        """The words as click takes them for what they are."""
        options = self.options_with_value()
        free = [word for before, word in pairwise(["", *words]) if before not in options]
        is_value = _is_the_value(free)
        for before, word in pairwise(["", *words]):
            if word == "-1" and before not in options and not is_value:
                is_value = True
                yield word
            else:
                yield word if before in options else self.shielded_word(word)


def ends_in_one() -> bool:
    """Whether the command line ends in its only "-1", which may be the option or a value."""
    return bool(click.get_current_context().meta[_ENDS_IN_ONE])


def _is_the_value(words: Sequence[str]) -> bool:
    """Whether -1 cannot be the option: "-r 5 /speed std_msgs/Int32 -1"."""
    plain = [word for word in words if word == "-1" or not word.startswith("-")]
    return len(plain) == _ONE_VALUE and plain[-1] == "-1" and not _EXCLUDE_ONE.isdisjoint(words)
