"""Rate, bandwidth and delay: sums over a window of the latest arrivals of a topic.

Arithmetic only; times come in as arguments.
"""

from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Iterable, Sequence
from math import sqrt
from operator import mul, sub
from typing import Generic, NamedTuple, TypeVar

_BLOCK = 1000  # numbers whose sums are computed once for all reports
ItemT = TypeVar("ItemT")
FoundT = TypeVar("FoundT")


class Statistics(NamedTuple):
    """Rates or delays, summed up as in rostopic hz and delay."""

    mean: float  # arrivals per second: 1 / the mean interval [Hz]; or the mean delay [s]
    # The shortest interval or delay [s]; a delay is negative if a clock is ahead.
    shortest: float
    longest: float  # the longest one [s]
    deviation: float  # their population standard deviation [s]
    window: int  # the number of arrivals


class Bandwidth(NamedTuple):
    """The bandwidth, summed up as in rostopic bw."""

    # The window's bytes over the time since its first arrival [byte/s]; it falls when nothing
    # more arrives.
    average: float
    mean: float  # the mean size [byte]
    smallest: int  # the smallest size [byte]
    largest: int  # the largest size [byte]
    window: int  # the number of arrivals


class Window(ABC, Generic[ItemT, FoundT]):
    """The latest arrivals of a topic."""

    _least = 2  # arrivals for a result
    _repeats = False  # True if there is a result even if nothing has arrived since the last

    def __init__(self) -> None:
        self.total = 0  # the number of arrivals in all
        self.is_timeless = False  # True if all arrivals have the same time
        self._since = 0  # the total at the last ``clear``
        self._reported = 0

    def add(self, *items: ItemT) -> None:
        """Add arrivals."""
        self.total += len(items)
        self._extend(items)

    def clear(self) -> None:
        """Forget all arrivals, because time begins again."""
        self._forget()
        self._since = self._reported = self.total

    def next_result(self, now: int = 0) -> FoundT | None:
        """Return the result at a time [ns], 0 for the last arrival's.

        None if there are too few arrivals, or nothing new, or no time has passed.
        """
        is_new = self._repeats or self.total != self._reported
        if not is_new or self.total - self._since < self._least:
            return None
        self._reported = self.total
        return self._sum_up(now)

    @abstractmethod
    def _extend(self, items: Sequence[ItemT]) -> None: ...

    @abstractmethod
    def _forget(self) -> None: ...

    @abstractmethod
    def _sum_up(self, now: int) -> FoundT | None: ...


class RateWindow(Window[int, Statistics]):
    """Times of ``size`` arrivals [ns]."""

    def __init__(self, size: int) -> None:
        super().__init__()
        self._intervals = _Numbers(size - 1)
        self._last: Sequence[int] = ()

    def _extend(self, items: Sequence[int]) -> None:
        times = (*self._last, *items)
        self._intervals.add(map(sub, times[1:], times))
        self._last = times[-1:]

    def _forget(self) -> None:
        self._intervals.clear()
        self._last = ()

    def _sum_up(self, now: int) -> Statistics | None:  # noqa: ARG002
        sums = self._intervals.sums()
        self.is_timeless = sums.shortest == sums.longest == 0
        if self.is_timeless:
            return None
        rate = sums.count * 1e9 / sums.total if sums.total > 0 else 0.0
        return _statistics(rate, sums, sums.count + 1)


class DelayWindow(Window[int, Statistics]):
    """``size`` delays [ns]."""

    _least = 1

    def __init__(self, size: int) -> None:
        super().__init__()
        self._delays = _Numbers(size)

    def _extend(self, items: Sequence[int]) -> None:
        self._delays.add(items)

    def _forget(self) -> None:
        self._delays.clear()

    def _sum_up(self, now: int) -> Statistics:  # noqa: ARG002
        sums = self._delays.sums()
        return _statistics(sums.total / sums.count / 1e9, sums, sums.count)


class BandwidthWindow(Window[tuple[int, int], Bandwidth]):
    """Times [ns] and sizes [byte] of ``size`` arrivals; time is at least the last one's."""

    _repeats = True

    def __init__(self, size: int) -> None:
        super().__init__()
        self._items: deque[tuple[int, int]] = deque(maxlen=size)

    def _extend(self, items: Sequence[tuple[int, int]]) -> None:
        self._items.extend(items)

    def _forget(self) -> None:
        self._items.clear()

    def _sum_up(self, now: int) -> Bandwidth | None:
        items = self._items
        times = [time for time, _ in items]
        self.is_timeless = not now and min(times) == max(times)
        if self.is_timeless:
            return None
        sizes = [size for _, size in items]
        seconds = (max(now or times[-1], times[-1]) - times[0]) / 1e9
        return Bandwidth(
            average=sum(sizes) / seconds if seconds > 0 else 0.0,
            mean=sum(sizes) / len(sizes),
            smallest=min(sizes),
            largest=max(sizes),
            window=len(sizes),
        )


class _Sums(NamedTuple):
    """Sums of integers; the sums of blocks of numbers can be combined."""

    count: int  # type: ignore[assignment] # not tuple.count
    total: int
    squares: int
    shortest: int
    longest: int


class _Numbers:
    """The latest ``size`` integers; a report on a long window costs no more than on a short one."""

    def __init__(self, size: int) -> None:
        self._size = size
        self._blocks: deque[tuple[list[int], _Sums]] = deque()
        self._latest: list[int] = []  # the newest, too few for a block

    def add(self, numbers: Iterable[int]) -> None:
        self._latest.extend(numbers)
        while len(self._latest) >= _BLOCK:
            block, self._latest = self._latest[:_BLOCK], self._latest[_BLOCK:]
            self._blocks.append((block, _sums(block)))
        while self._blocks and self._excess() >= _BLOCK:
            self._blocks.popleft()

    def clear(self) -> None:
        self._blocks.clear()
        self._latest.clear()

    def sums(self) -> _Sums:
        """Return the sums of all; at least one number is needed."""
        excess, latest = self._excess(), self._latest
        parts = [sums for _, sums in self._blocks]
        if excess > 0 and parts:
            parts[0] = _sums(self._blocks[0][0][excess:])
        elif excess > 0:
            latest = latest[excess:]
        if latest:
            parts.append(_sums(latest))
        counts, totals, squares, shortest, longest = zip(*parts, strict=True)
        return _Sums(sum(counts), sum(totals), sum(squares), min(shortest), max(longest))

    def _excess(self) -> int:
        return len(self._blocks) * _BLOCK + len(self._latest) - self._size


def _sums(numbers: Sequence[int]) -> _Sums:
    squares = sum(map(mul, numbers, numbers))
    return _Sums(len(numbers), sum(numbers), squares, min(numbers), max(numbers))


def _statistics(mean: float, sums: _Sums, window: int) -> Statistics:
    # integers, so that the difference of large sums is exact
    count, total, squares, shortest, longest = sums
    deviation = sqrt(count * squares - total * total) / count
    return Statistics(mean, shortest / 1e9, longest / 1e9, deviation / 1e9, window)
