"""Command lines whose last argument takes every word that is no option, "-1" and "-0.5" too."""

from collections.abc import Collection, Iterator, Sequence
from itertools import pairwise
from typing import ClassVar

import click

from lcmtools.cli.dashes import Dashes

WITHOUT_END = "forever"
"""What the options of ``may_stand_alone`` are where they stand alone."""


class CommandWithWords(click.Command):
    """A command whose last argument takes negative numbers and YAML as they are.

    What follows an option that takes a value is that value, whatever it looks like.

    Attributes:
        may_stand_alone: Options whose value is given with "=" or not at all.
        dashes: Which words that begin with "-" are none of click's options.
    """

    may_stand_alone: tuple[str, ...] = ()
    dashes: ClassVar[Dashes] = Dashes()

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the command line."""
        rest = super().parse_args(ctx, list(self.shielded(args)))
        name = next(p.name for p in self.params if p.nargs == -1) or ""
        ctx.params[name] = tuple(self.dashes.bare(word) for word in ctx.params[name] or ())
        return rest

    def shielded(self, words: Sequence[str]) -> Iterator[str]:
        """The words as click takes them for what they are."""
        options = self.options_with_value()
        for before, word in pairwise(["", *words]):
            yield word if before in options else self.shielded_word(word)

    def options_with_value(self) -> Collection[str]:
        """The names of the options that take the next word, whatever it is."""
        options = (p for p in self.params if isinstance(p, click.Option) and not p.is_flag)
        return {name for option in options for name in option.opts} - set(self.may_stand_alone)

    def shielded_word(self, word: str) -> str:
        """A word that belongs to no option before it, as click takes it."""
        if word in self.may_stand_alone:
            return f"{word}={WITHOUT_END}"
        return self.dashes.shielded(word)
