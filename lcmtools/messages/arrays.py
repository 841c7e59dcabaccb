"""Arrays of more than one dimension in a payload.

Belongs here: an array is its elements row by row; its sizes are elsewhere. Must not know what the
elements are (see ``rows``), nor where the sizes come from.
"""

from collections.abc import Sequence
from math import prod

from lcmtools.messages.rows import Cursor, Malformed, Row, check_count
from lcmtools.messages.shape import as_sequence


class Array:
    """An array field of several dimensions, made of rows of one kind."""

    def __init__(self, row: Row, where: str) -> None:
        self._row = row
        self._where = where

    def write(self, values: object, sizes: Sequence[int], parts: list[bytes]) -> None:
        """Append its bytes; all sizes must be right.

        Raises:
            ValueError: A size is not.
        """
        count, inner = sizes[0], sizes[1:]
        if not inner:
            self._row.write(values, count, parts)
            return
        rows = as_sequence(values)
        check_count(rows, count)
        for row in rows:
            self.write(row, inner, parts)

    def read(self, sizes: Sequence[int], cursor: Cursor) -> object:
        """The array of these sizes, outermost first."""
        count, inner = sizes[0], sizes[1:]
        if not inner:
            return self._row.read(count, cursor)
        if min(sizes) < 0:
            raise Malformed(f"negative length at {self._where}")
        cursor.expect(count, prod(inner) * self._row.smallest(), self._where)
        return [self.read(inner, cursor) for _ in range(count)]


def length(old: int, *arrays: tuple[object, int]) -> int:
    """The value of a length field: the length of the first array that depends on it.

    Args:
        old: What it holds, which stays where no array tells (an inner size without any row).
        arrays: The arrays that share it, each with the dimension that it gives, 0 the outermost.
    """
    for values, depth in arrays:
        count = _row_length(values, depth)
        if count is not None:
            return count
    return old


def _row_length(values: object, depth: int) -> int | None:
    """The length of the first row at a depth, None where there is none."""
    for _ in range(depth):
        rows = as_sequence(values)
        if not rows:
            return None
        values = rows[0]
    return len(values)  # type: ignore[arg-type] # TypeError, when it is no array
