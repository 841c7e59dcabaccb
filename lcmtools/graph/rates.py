"""How often something comes: rates over a window of arrival times. Plain arithmetic."""

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from math import sqrt


@dataclass(frozen=True, slots=True)
class Rate:
    """The intervals between arrivals, as rostopic hz sums them up.

    Attributes:
        mean: Arrivals per second: 1 / the mean interval [Hz].
        shortest: The shortest interval [s].
        longest: The longest interval [s].
        deviation: The population standard deviation of the intervals [s].
        window: How many arrivals this is about.
    """

    mean: float
    shortest: float
    longest: float
    deviation: float
    window: int


class RateWindow:
    """The latest arrivals of one stream.

    Args:
        size: How many arrivals are kept; at least 2.
    """

    def __init__(self, size: int) -> None:
        self.total = 0
        """Arrivals ever."""
        self._times: deque[int] = deque(maxlen=size)
        self._reported = 0

    def extend(self, times: Iterable[int]) -> None:
        """Add arrivals, in nanoseconds."""
        for time in times:
            self._times.append(time)
            self.total += 1

    def take(self) -> Rate | None:
        """The rate; None when nothing came since it was last taken, or before two arrivals."""
        if self.total == self._reported or len(self._times) < 2:  # noqa: PLR2004 - an interval
            return None
        self._reported = self.total
        times = list(self._times)
        intervals = [(b - a) / 1e9 for a, b in pairwise(times)]
        mean = sum(intervals) / len(intervals)
        variance = sum((interval - mean) ** 2 for interval in intervals) / len(intervals)
        return Rate(
            mean=1 / mean if mean > 0 else 0.0,
            shortest=min(intervals),
            longest=max(intervals),
            deviation=sqrt(variance),
            window=len(times),
        )
