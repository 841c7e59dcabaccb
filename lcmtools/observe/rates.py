"""Rate, bandwidth and delay: sums over a window of the latest arrivals of a topic.

Plain arithmetic; times come in as arguments.
"""

from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Sequence
from itertools import islice
from math import sqrt
from operator import mul, sub
from typing import Generic, NamedTuple, TypeVar

ItemT = TypeVar("ItemT")
FoundT = TypeVar("FoundT")


class Statistics(NamedTuple):
    """Rates or delays, as rostopic hz and delay sum them up."""

    mean: float  # arrivals per second: 1 / the mean interval [Hz]; or the mean delay [s]
    # The shortest interval or delay [s]; a delay is negative where a clock is ahead.
    shortest: float
    longest: float  # the longest one [s]
    deviation: float  # their population standard deviation [s]
    window: int  # the number of arrivals


class Bandwidth(NamedTuple):
    """The bandwidth, as rostopic bw sums it up."""

    # The window's bytes over the time since its first arrival [byte/s]; it falls when nothing
    # comes any more.
    average: float
    mean: float  # the mean size [byte]
    smallest: int  # the smallest size [byte]
    largest: int  # the largest size [byte]
    window: int  # the number of arrivals


class Window(ABC, Generic[ItemT, FoundT]):
    """The latest ``size`` arrivals of a topic.

    Attributes:
        total: The number of arrivals ever.
    """

    _least = 2  # arrivals
    _repeats = False  # True if it tells something where nothing has arrived since the last time

    def __init__(self, size: int) -> None:
        self.total = 0
        self._items: deque[ItemT] = deque(maxlen=size)
        self._reported = 0

    def add(self, *items: ItemT) -> None:
        """Add arrivals."""
        self._items.extend(items)
        self.total += len(items)

    def clear(self) -> None:
        """Forget all arrivals: time begins again."""
        self._items.clear()
        self._reported = self.total

    def take(self, now: int = 0) -> FoundT | None:
        """Return the sums at a time [ns]; None for too few arrivals, or nothing new."""
        is_new = self._repeats or self.total != self._reported
        if not is_new or len(self._items) < self._least:
            return None
        self._reported = self.total
        return self._sum_up(self._items, now)

    @abstractmethod
    def _sum_up(self, items: Sequence[ItemT], now: int) -> FoundT: ...


class RateWindow(Window[int, Statistics]):
    """Times of arrival [ns]."""

    def _sum_up(self, items: Sequence[int], now: int) -> Statistics:  # noqa: ARG002
        intervals = [*map(sub, islice(items, 1, None), items)]
        waited = items[-1] - items[0]
        return _statistics(
            len(intervals) * 1e9 / waited if waited > 0 else 0.0, intervals, len(items)
        )


class DelayWindow(Window[int, Statistics]):
    """Delays [ns]."""

    _least = 1

    def _sum_up(self, items: Sequence[int], now: int) -> Statistics:  # noqa: ARG002
        return _statistics(sum(items) / len(items) / 1e9, items, len(items))


class BandwidthWindow(Window[tuple[int, int], Bandwidth]):
    """Times of arrival [ns], and sizes [byte]; the time is that of the last one at least."""

    _repeats = True

    def _sum_up(self, items: Sequence[tuple[int, int]], now: int) -> Bandwidth:
        sizes = [size for _, size in items]
        seconds = (max(now, items[-1][0]) - items[0][0]) / 1e9
        return Bandwidth(
            average=sum(sizes) / seconds if seconds > 0 else 0.0,
            mean=sum(sizes) / len(sizes),
            smallest=min(sizes),
            largest=max(sizes),
            window=len(sizes),
        )


def _statistics(mean: float, values: Sequence[int], window: int) -> Statistics:
    # of whole numbers, so that the difference of large sums is exact
    count, total = len(values), sum(values)
    deviation = sqrt(count * sum(map(mul, values, values)) - total * total) / count
    return Statistics(mean, min(values) / 1e9, max(values) / 1e9, deviation / 1e9, window)
