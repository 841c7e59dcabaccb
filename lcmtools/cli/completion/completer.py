"""Completers, declared on options and arguments: ``completer="bus:topics"`` (see ``declare``).

Every command imports this module: it imports nothing itself.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # click takes longer to import than a completion otherwise takes
    import click

Source = str | Sequence[Sequence[str]]
"""The origin of candidates: "module:function", "files", "" for nowhere; or words with help."""


class Completer:
    """The completer of a parameter, as click's ``shell_complete`` takes it.

    A module without a dot is one of this package. Fixed candidates change with the code only: they
    are read with the command, and kept.
    """

    def __init__(self, source: Source, *, is_fixed: bool = False) -> None:
        self._source = source
        self._is_fixed = is_fixed

    def source(self) -> Source:
        """Return the source as plain data."""
        if not self._is_fixed:
            return self._source
        from lcmtools.cli.completion.situation import Situation, candidates

        return [[one.value, one.help] for one in candidates(self._source, Situation())]

    def __call__(self, ctx: "click.Context", _: "click.Parameter", incomplete: str) -> list[str]:
        """Return the candidates for click's own completion."""
        from lcmtools.cli.completion.situation import FILES, Situation, candidates

        given = {
            name: [str(one) for one in (value if isinstance(value, tuple) else [value])]
            for name, value in ctx.params.items()
            if value is not None
        }
        found = candidates(self._source, Situation(incomplete, given))
        return [one.value for one in found if one is not FILES and one.value.startswith(incomplete)]
