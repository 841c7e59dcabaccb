"""Values on a command line that begin with "-", which click would read as options."""

from collections.abc import Container, Iterator, Sequence
from itertools import pairwise

import click

from lcmtools.cli.dashes import Dashes

_DASHES = Dashes(also=r"--(?=\s)", but="-1[a-z]+")
"""Documents of YAML, too; but "-1v" is two options."""
_EXCLUDE_ONE = frozenset(("-r", "--rate", "-t", "--times"))
"""Options that the option -1 cannot stand beside."""
_ONE_VALUE = 3  # words: TOPIC, TYPE and the value
_ENDS_IN_ONE = f"{__name__}.ends_in_one"


class CommandWithValues(click.Command):
    """A command with the option -1 that takes negative numbers and YAML lists for values."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the command line, whose argument "values" takes what is no option."""
        ctx.meta[_ENDS_IN_ONE] = args.count("-1") == 1 and args[-1] == "-1"
        options = {name for option in self.params if _takes_value(option) for name in option.opts}
        rest = super().parse_args(ctx, list(_shielded(args, options)))
        ctx.params["values"] = tuple(_DASHES.bare(value) for value in ctx.params["values"])
        return rest


def ends_in_one() -> bool:
    """Whether the command line ends in its only "-1", which may be the option or a value."""
    return bool(click.get_current_context().meta[_ENDS_IN_ONE])


def _takes_value(parameter: click.Parameter) -> bool:
    return isinstance(parameter, click.Option) and not parameter.is_flag


def _shielded(words: Sequence[str], options: Container[str]) -> Iterator[str]:
    """The words with a blank before those that are values; ``options`` are followed by one."""
    free = [word for before, word in pairwise(["", *words]) if before not in options]
    is_value = _is_the_value(free)
    for before, word in pairwise(["", *words]):
        if before in options:
            yield word  # click takes it, whatever it is
        elif word == "-1" and not is_value:
            is_value = True  # the first -1 is the option, as in "rostopic pub -1"
            yield word
        else:
            yield _DASHES.shielded(word)


def _is_the_value(words: Sequence[str]) -> bool:
    """Whether -1 cannot be the option: "-r 5 /speed std_msgs/Int32 -1"."""
    plain = [word for word in words if word == "-1" or not word.startswith("-")]
    return len(plain) == _ONE_VALUE and plain[-1] == "-1" and not _EXCLUDE_ONE.isdisjoint(words)
