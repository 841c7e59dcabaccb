"""Numbers over time as small curves of text: a sparkline, and a plot of braille dots.

Pure functions of samples, which are times in nanoseconds with numbers, in order.
"""

import math
from collections.abc import Iterable, Sequence

Sample = tuple[int, float]

_BARS = "▁▂▃▄▅▆▇█"
_FLAT = "▄"
_DOTS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))  # of a braille cell, by row
_BRAILLE = 0x2800
_CELL_ROWS, _CELL_COLUMNS = 4, 2


def sparkline(samples: Iterable[Sample], now: int, width: int, bin_ns: int) -> str:
    """A line of bars, a bar for a stretch of time; the newest at the right.

    Where nothing came for a while the bar before goes on. Bars stand for fixed stretches, so that
    the line moves to the left as time goes by and does not flicker.

    Args:
        samples: Times [ns] with numbers; what is not finite is left out.
        now: The time at the right end [ns].
        width: How many bars.
        bin_ns: The time that a bar stands for [ns].
    """
    means = _means(samples, now, width, bin_ns)
    known = [value for value in means if value is not None]
    if not known:
        return " " * width
    low, high = min(known), max(known)
    return "".join(" " if value is None else _bar(value, low, high) for value in means)


def _bar(value: float, low: float, high: float) -> str:
    if high <= low:
        return _FLAT
    return _BARS[min(len(_BARS) - 1, int(_share(value, low, high) * len(_BARS)))]


def _share(value: float, low: float, high: float) -> float:
    """Where a value is between two others, 0 to 1; halves, as their difference may be infinite."""
    return (value / 2 - low / 2) / (high / 2 - low / 2)


def _means(samples: Iterable[Sample], now: int, width: int, bin_ns: int) -> list[float | None]:
    """The mean number of each stretch of time; None before the first."""
    last = now // bin_ns
    bins: dict[int, list[float]] = {}
    before: float | None = None
    for time, value in samples:
        if not math.isfinite(value):
            continue
        place = time // bin_ns - last + width - 1
        if place < 0:
            before = value
        else:
            bins.setdefault(min(place, width - 1), []).append(value)
    means: list[float | None] = []
    for place in range(width):
        values = bins.get(place)
        if values:
            low, high = min(values), max(values)
            mean = math.fsum(value / len(values) for value in values)
            before = max(low, min(mean, high))  # what is constant stays so when it is rounded
        means.append(before)
    return means


def plot(samples: Sequence[Sample], now: int, width: int, height: int, span: int) -> list[str]:
    """A curve of braille dots with its axes.

    Args:
        samples: Times [ns] with numbers.
        now: The time at the right end [ns].
        width: Characters of a line.
        height: Lines, with the one below the curve.
        span: How much time the curve is about [ns].

    Returns:
        The lines; without a finite number only one that says so.
    """
    points = [(t, v) for t, v in samples if math.isfinite(v) and now - span <= t <= now]
    if not points:
        return [f"no number in the last {span / 1e9:.0f} s"]
    low, high = min(v for _, v in points), max(v for _, v in points)
    labels = {0: number_text(high), height - 2: number_text(low)}
    if height > 4:  # noqa: PLR2004 - room between the two
        labels[(height - 2) // 2] = number_text(low / 2 + high / 2)
    margin = max(map(len, labels.values()))
    columns, rows = max(1, width - margin - 2), max(1, height - 1)
    cells = _curve(points, (now - span, span), (low, high), (columns, rows))
    lines = [
        f"{labels.get(row, ''):>{margin}} {'┤' if row in labels else '│'}{cells[row]}"
        for row in range(rows)
    ]
    left, right = f"-{span / 1e9:g} s", "now"
    lines.append(f"{' ' * margin} └{left}{' ' * max(1, columns - len(left) - len(right))}{right}")
    return lines


def _curve(
    points: Sequence[Sample],
    times: tuple[int, int],
    values: tuple[float, float],
    size: tuple[int, int],
) -> list[str]:
    """The dots of a curve, each column's joined to those of the one before."""
    columns, rows = size
    start, span = times
    low, high = values
    wide, tall = columns * _CELL_COLUMNS - 1, rows * _CELL_ROWS - 1
    grid = [[0] * columns for _ in range(rows)]
    before: tuple[int, int] | None = None
    for time, value in points:
        x = min(wide, (time - start) * (wide + 1) // span)
        y = tall // 2 if high <= low else round((1 - _share(value, low, high)) * tall)
        for dot_x, dot_y in _joined(before, (x, y)):
            cell, part = divmod(dot_x, _CELL_COLUMNS)
            line, place = divmod(dot_y, _CELL_ROWS)
            grid[line][cell] |= _DOTS[place][part]
        before = x, y
    return ["".join(chr(_BRAILLE + dots) if dots else " " for dots in line) for line in grid]


def _joined(before: tuple[int, int] | None, now: tuple[int, int]) -> Iterable[tuple[int, int]]:
    """The dots from one point to another: a straight line."""
    if before is None:
        return [now]
    (x0, y0), (x1, y1) = before, now
    steps = max(abs(x1 - x0), abs(y1 - y0), 1)
    return [
        (round(x0 + (x1 - x0) * i / steps), round(y0 + (y1 - y0) * i / steps))
        for i in range(1, steps + 1)
    ]


def number_text(value: float) -> str:
    """A number in at most eleven characters."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int) and abs(value) < 10**10:
        return str(value)
    return f"{value:.5g}"
