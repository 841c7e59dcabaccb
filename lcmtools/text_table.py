"""Tables of text, and numbers of things. Pure.

``observe.channels.table`` lays out the table that fits a terminal.
"""

from collections.abc import Sequence

_GAP_OF_ROSTOPIC = "   "


def plural(number: int, noun: str) -> str:
    """Return a number of things in words: "1 message", "2 messages"."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def text_table(rows: Sequence[Sequence[str]], heading: Sequence[str] = ()) -> list[str]:
    """Return the lines of a table, its columns aligned and two spaces apart.

    A heading is centred above a rule, and the columns are three spaces apart, as in rostopic hz.
    """
    cells = [heading, *rows] if heading else rows
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    if not heading:
        return [_line(row, widths, "<", "  ") for row in rows]
    gap = _GAP_OF_ROSTOPIC
    rule = "=" * (sum(widths) + len(gap) * (len(widths) - 1))
    return [_line(heading, widths, "^", gap), rule, *(_line(r, widths, "<", gap) for r in rows)]


def _line(row: Sequence[str], widths: Sequence[int], side: str, gap: str) -> str:
    cells = (f"{cell:{side}{width}}" for cell, width in zip(row, widths, strict=True))
    return gap.join(cells).rstrip()
