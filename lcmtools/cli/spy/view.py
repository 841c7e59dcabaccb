"""How the table is looked at: by which column it is sorted, and what is filtered out."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from lcmtools.cli.spy.columns import COLUMNS, sorted_rows
from lcmtools.observe.channels import Row, matching


@dataclass(frozen=True, slots=True)
class View:
    """How the table is looked at.

    Attributes:
        column: The name of the column that it is sorted by.
        inverted: Whether numbers are sorted from the smallest, and texts from Z.
        text: What a row must have in channel, type, sender or listener; "" for any.
    """

    column: str = "channel"
    inverted: bool = False
    text: str = ""

    def rows(self, rows: Sequence[Row], *, steady: bool = False) -> list[Row]:
        """The rows that are shown, in their order; ``steady`` as ``sorted_rows`` has it."""
        found = matching(rows, self.text)
        return sorted_rows(found, self.column, inverted=self.inverted, steady=steady)

    def sorted_by(self, column: str) -> "View":
        """The same, sorted by a column; by the same column again, the other way round."""
        if column == self.column:
            return replace(self, inverted=not self.inverted)
        return replace(self, column=column, inverted=False)

    def moved(self, step: int) -> "View":
        """The same, sorted by the next column, or the one before."""
        names = list(COLUMNS)
        place = (names.index(self.column) + step) % len(names)
        return replace(self, column=names[place], inverted=False)

    def filtered(self, text: str) -> "View":
        """The same with another filter."""
        return replace(self, text=text)
