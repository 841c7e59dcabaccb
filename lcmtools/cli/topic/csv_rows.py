"""The rows of ``echo --csv``: columns that stay where they are."""

import csv
import io

from lcmtools.cli.output import talk
from lcmtools.messages.cells import Cell


class Table:
    """Rows of comma-separated values under the columns of the first one.

    All rows are of one kind of message: others are left out, which is said once for each kind.
    """

    def __init__(self) -> None:
        self._columns: list[str] = []
        self._kind = ""
        self._told: set[str] = set()

    def row(self, cells: dict[str, Cell], kind: str) -> str | None:
        """The row of a message, after the line with the columns' names if it is the first.

        A column that a message does not have is empty; values without a column are left out, which
        is said once.

        Args:
            cells: The values by column.
            kind: What the values are of: the name of a type, or several.
        """
        head = "" if self._columns else f"{_line(list(cells))}\n"
        if head:
            self._columns, self._kind = list(cells), kind
        elif kind != self._kind:
            self._tell(f"messages of {kind} are left out: the columns are those of {self._kind}")
            return None
        more = len(cells.keys() - set(self._columns))
        if more and "more" not in self._told:
            self._told.add("more")
            talk(
                f"lcmtools echo: no column for {more} more in an array that was shorter in the"
                " first message; --field with a slice gives all rows the same columns"
            )
        return head + _line([cells.get(column, "") for column in self._columns])

    def _tell(self, text: str) -> None:
        if text not in self._told:
            self._told.add(text)
            talk(f"lcmtools echo: {text}")


def _line(cells: "list[str] | list[Cell]") -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="").writerow(cells)
    return text.getvalue()
