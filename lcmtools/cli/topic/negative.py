"""Values on a command line that begin with "-", which click would read as options."""

import re
from collections.abc import Iterator, Sequence

import click

_NEGATIVE = re.compile(r"-(\.?\d|\.?inf|\s)", re.IGNORECASE)
_SHIELDED = re.compile(f"^ (?={_NEGATIVE.pattern})", re.IGNORECASE)
_ENDS_IN_ONE = f"{__name__}.ends_in_one"


class CommandWithValues(click.Command):
    """A command with the option -1 that takes negative numbers and YAML lists for values."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the command line, whose argument "values" takes what is no option."""
        ctx.meta[_ENDS_IN_ONE] = args.count("-1") == 1 and args[-1] == "-1"
        rest = super().parse_args(ctx, list(_shielded(args)))
        ctx.params["values"] = tuple(_SHIELDED.sub("", value) for value in ctx.params["values"])
        return rest


def ends_in_one() -> bool:
    """Whether the command line ends in its only "-1", which may be the option or a value."""
    return bool(click.get_current_context().meta[_ENDS_IN_ONE])


def _shielded(words: Sequence[str]) -> Iterator[str]:
    """The words with a blank before those that are values."""
    is_option = True  # the first -1 is the option, as in "rostopic pub -1"
    for word in words:
        if word == "-1" and is_option:
            is_option = False
            yield word
        else:
            yield f" {word}" if _NEGATIVE.match(word) else word
