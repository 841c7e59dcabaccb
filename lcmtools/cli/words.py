"""Command lines whose last argument takes every word that is no option, "-1" and "-0.5" too."""

import click

from lcmtools.cli.dashes import Dashes

_DASHES = Dashes(also=r"\.?nan")
WITHOUT_END = "forever"
"""What the options of ``may_stand_alone`` are where they stand alone."""


class CommandWithWords(click.Command):
    """A command whose argument "words" takes negative numbers and YAML lists as they are.

    Attributes:
        may_stand_alone: Options whose value is given with "=" or not at all.
    """

    may_stand_alone: tuple[str, ...] = ()

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the command line."""
        rest = super().parse_args(ctx, [self._shielded(word) for word in args])
        ctx.params["words"] = tuple(_DASHES.bare(word) for word in ctx.params["words"] or ())
        return rest

    def _shielded(self, word: str) -> str:
        """A word as click takes it for what it is."""
        if word in self.may_stand_alone:
            return f"{word}={WITHOUT_END}"
        return _DASHES.shielded(word)
