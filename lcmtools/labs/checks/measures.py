"""Measures of step responses, circles and pictures. Pure numbers."""

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass

Point = tuple[float, float]

BAND = 0.05  # within this part of the target it counts as reached
GOOD = 0.9  # from here on a picture counts as right
_LAST = 1.0  # [s] whose mean is the value reached
_CLASSES = 64
_FLAT = 1e-12


@dataclass(frozen=True, slots=True)
class Response:
    """The response to a step, with the usual measures of control engineering."""

    reached: float  # mean of the last second, in the value's unit
    settled_after: float | None  # [s] until it stays within the band; None when it does not
    overshoot: float  # beyond the target, as a part of the step; 0 when it never was


def analyse(samples: Sequence[tuple[float, float]], target: float) -> Response:
    """Measure the response in samples of (time since the step [s], value), ordered by time.

    There is at least one sample, and ``target``, the desired value, is not 0.
    """
    end = samples[-1][0]
    reached = statistics.fmean(value for time, value in samples if time >= end - _LAST)
    beyond = max((value - target) / target for _, value in samples)
    return Response(reached, _settled_after(samples, target), max(0.0, beyond))


def is_within(value: float, target: float) -> bool:
    """Return True if a value is within the band around the target."""
    return abs(value - target) <= BAND * abs(target)


def _settled_after(samples: Sequence[tuple[float, float]], target: float) -> float | None:
    settled: float | None = None
    for time, value in samples:
        if not is_within(value, target):
            settled = None
        elif settled is None:
            settled = time
    return settled


def velocity_text(velocity: tuple[float, float]) -> str:
    """Format a forward speed and a turn rate with their units."""
    return "{:+.3f} m/s, {:+.3f} rad/s".format(*velocity)


def fit_radius(points: Sequence[Point]) -> float | None:
    """Return the radius of the circle through points [m]; None if they form no arc.

    Source: I. Kasa, A circle fitting procedure and its error analysis, IEEE Trans. Instrum. Meas.
    25 (1976): the circle is linear in its centre and in r^2 - |centre|^2, so that least squares is
    one small system of equations.
    """
    if len(points) < 3:  # noqa: PLR2004 - fewer make no circle
        return None
    middle_x = statistics.fmean(x for x, _ in points)
    middle_y = statistics.fmean(y for _, y in points)
    centred = [(x - middle_x, y - middle_y) for x, y in points]
    xx = statistics.fmean(x * x for x, _ in centred)
    yy = statistics.fmean(y * y for _, y in centred)
    xy = statistics.fmean(x * y for x, y in centred)
    by_x = statistics.fmean(x * (x * x + y * y) for x, y in centred) / 2
    by_y = statistics.fmean(y * (x * x + y * y) for x, y in centred) / 2
    determinant = xx * yy - xy * xy
    if determinant <= _FLAT * max(xx, yy, _FLAT) ** 2:
        return None
    centre_x = (by_x * yy - by_y * xy) / determinant
    centre_y = (by_y * xx - by_x * xy) / determinant
    return math.sqrt(centre_x**2 + centre_y**2 + xx + yy)


def explained(depths: Sequence[int], colors: Sequence[Sequence[float]]) -> float:
    """Return the fraction of the colours' variance that the depths explain, from 0 to 1.

    The correlation ratio (eta squared; K. Pearson, 1905). Any colour map is as good as another:
    pixels of the same depth must look the same. A picture of something else, one upside down or one
    that is all black explains little or nothing. ``depths`` has a number for each pixel, in any
    unit, 0 where there is no reading; ``colors`` one or three for each pixel of the picture.
    """
    total = _scatter(colors)
    if total <= 0.0:
        return 0.0
    order = sorted(range(len(depths)), key=depths.__getitem__)
    size = max(1, -(-len(order) // _CLASSES))  # of classes of about equal depth
    pieces = [order[start : start + size] for start in range(0, len(order), size)]
    return 1.0 - sum(_scatter([colors[pixel] for pixel in piece]) for piece in pieces) / total


def _scatter(colors: Sequence[Sequence[float]]) -> float:
    """Return the sum of squared distances from the mean."""
    total = 0.0
    for values in zip(*colors, strict=True):
        mean = sum(values) / len(values)
        total += sum((value - mean) ** 2 for value in values)
    return total
