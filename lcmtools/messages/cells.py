"""Plain values as the cells of a table, under the names that ``rostopic echo -p`` gives columns.

Belongs here: ``field.header.stamp``, ``field.points0.x``. Must not know how a row is written.
"""

from typing import TypeAlias, cast

from lcmtools.messages.fields import TIME_FIELDS
from lcmtools.messages.plain import Plain

Cell: TypeAlias = "int | float | str"


def cells(plain: Plain, name: str = "field") -> dict[str, Cell]:
    """The single values in a plain one, by column.

    A time or a duration is one cell, in nanoseconds; a boolean is 1 or 0.
    """
    if isinstance(plain, dict) and tuple(plain) in TIME_FIELDS:
        seconds, nanoseconds = cast("dict[str, int]", plain).values()
        return {name: seconds * 1_000_000_000 + nanoseconds}
    if isinstance(plain, dict):
        parts = [(f"{name}.{key}", value) for key, value in plain.items()]
    elif isinstance(plain, list):
        parts = [(f"{name}{index}", value) for index, value in enumerate(plain)]
    else:
        return {name: int(plain) if isinstance(plain, bool) else plain}
    return {column: cell for part, value in parts for column, cell in cells(value, part).items()}
