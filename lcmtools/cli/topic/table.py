"""The table that rostopic hz prints for several topics."""

from collections.abc import Sequence

_GAP = "   "


def table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """The lines of a table: centred header, a rule, rows, and an empty line after them."""
    widths = [max(map(len, column)) for column in zip(header, *rows, strict=True)]
    head = (f"{name:^{width}}" for name, width in zip(header, widths, strict=True))
    rule = "=" * (sum(widths) + len(_GAP) * (len(widths) - 1))
    return [_GAP.join(head).rstrip(), rule, *(_row(row, widths) for row in rows), ""]


def _row(cells: Sequence[str], widths: Sequence[int]) -> str:
    pairs = zip(cells, widths, strict=True)
    return _GAP.join(f"{cell:<{width}}" for cell, width in pairs).rstrip()
