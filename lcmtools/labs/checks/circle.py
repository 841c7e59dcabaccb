"""The circle that fits points best. Pure numbers.

Source: I. Kasa, A circle fitting procedure and its error analysis, IEEE Trans. Instrum. Meas. 25
(1976): the circle is linear in its centre and in r^2 - |centre|^2, so that least squares is one
small system of equations.
"""

import math
import statistics
from collections.abc import Sequence

Point = tuple[float, float]
_FLAT = 1e-12


def fit_radius(points: Sequence[Point]) -> float | None:
    """The radius of the circle through the points [m]; None for less than a piece of a circle."""
    if len(points) < 3:  # noqa: PLR2004 - fewer make no circle
        return None
    middle_x = statistics.fmean(x for x, _ in points)
    middle_y = statistics.fmean(y for _, y in points)
    centred = [(x - middle_x, y - middle_y) for x, y in points]
    return _radius(centred)


def _radius(points: Sequence[Point]) -> float | None:
    """The same for points whose mean is 0."""
    count = len(points)
    xx = sum(x * x for x, _ in points) / count
    yy = sum(y * y for _, y in points) / count
    xy = sum(x * y for x, y in points) / count
    by_x = sum(x * (x * x + y * y) for x, y in points) / count / 2
    by_y = sum(y * (x * x + y * y) for x, y in points) / count / 2
    determinant = xx * yy - xy * xy
    if determinant <= _FLAT * max(xx, yy, _FLAT) ** 2:
        return None
    centre_x = (by_x * yy - by_y * xy) / determinant
    centre_y = (by_y * xx - by_x * xy) / determinant
    return math.sqrt(centre_x**2 + centre_y**2 + xx + yy)
