"""Rate, bandwidth and delay: sums over a window of the latest arrivals.

And how often by what endpoints count themselves. Plain arithmetic; times come in as arguments.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import sqrt

from lcmtools.graph.model import Endpoint, Node


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


@dataclass(frozen=True, slots=True)
class Bandwidth:
    """The bandwidth, as rostopic bw sums it up.

    Attributes:
        average: The window's bytes over the time since its first arrival [byte/s]; it falls when
            nothing comes any more.
        mean: The mean size [byte].
        smallest: The smallest size [byte].
        largest: The largest size [byte].
        window: How many arrivals this is about.
    """

    average: float
    mean: float
    smallest: int
    largest: int
    window: int


@dataclass(frozen=True, slots=True)
class Delay:
    """The delay, as rostopic delay sums it up.

    Attributes:
        mean: The mean delay [s].
        shortest: The shortest delay [s]; negative where a clock is ahead.
        longest: The longest delay [s].
        deviation: The population standard deviation of the delays [s].
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

    def add(self, time: int) -> None:
        """Add an arrival, in nanoseconds."""
        self._times.append(time)
        self.total += 1

    def clear(self) -> None:
        """Forget all arrivals: time begins again."""
        self._times.clear()
        self._reported = self.total

    def take(self, now: int = 0) -> Rate | None:  # noqa: ARG002 - as the others
        """Return the rate; None before two arrivals, and when nothing came since the last one."""
        if self.total == self._reported or len(self._times) < 2:  # noqa: PLR2004 - an interval
            return None
        self._reported = self.total
        intervals = [(b - a) / 1e9 for a, b in pairwise(self._times)]
        mean = sum(intervals) / len(intervals)
        return Rate(
            mean=1 / mean if mean > 0 else 0.0,
            shortest=min(intervals),
            longest=max(intervals),
            deviation=_deviation(intervals),
            window=len(self._times),
        )


class BandwidthWindow:
    """The sizes of the latest arrivals of one stream.

    Args:
        size: How many arrivals are kept; at least 2.
    """

    def __init__(self, size: int) -> None:
        self.total = 0
        """Arrivals ever."""
        self._arrivals: deque[tuple[int, int]] = deque(maxlen=size)

    def add(self, time: int, size: int) -> None:
        """Add an arrival: when, in nanoseconds, and how many bytes."""
        self._arrivals.append((time, size))
        self.total += 1

    def clear(self) -> None:
        """Forget all arrivals."""
        self._arrivals.clear()

    def take(self, now: int) -> Bandwidth | None:
        """The bandwidth at a time in nanoseconds, or at the last arrival where that is later.

        None before two arrivals.
        """
        if len(self._arrivals) < 2:  # noqa: PLR2004 - the time between
            return None
        sizes = [size for _, size in self._arrivals]
        seconds = (max(now, self._arrivals[-1][0]) - self._arrivals[0][0]) / 1e9
        return Bandwidth(
            average=sum(sizes) / seconds if seconds > 0 else 0.0,
            mean=sum(sizes) / len(sizes),
            smallest=min(sizes),
            largest=max(sizes),
            window=len(sizes),
        )


class DelayWindow:
    """The delays of the latest arrivals of one stream.

    Args:
        size: How many arrivals are kept; at least 1.
    """

    def __init__(self, size: int) -> None:
        self.total = 0
        """Arrivals ever."""
        self._delays: deque[float] = deque(maxlen=size)
        self._is_new = False

    def add(self, arrived: int, stamped: int) -> None:
        """Add an arrival: when it came and when it was stamped, in nanoseconds."""
        self._delays.append((arrived - stamped) / 1e9)
        self.total += 1
        self._is_new = True

    def clear(self) -> None:
        """Forget all arrivals."""
        self._delays.clear()
        self._is_new = False

    def take(self, now: int = 0) -> Delay | None:  # noqa: ARG002 - as the others
        """Return the delay; None when nothing came since it was last taken."""
        if not self._is_new:
            return None
        self._is_new = False
        return Delay(
            mean=sum(self._delays) / len(self._delays),
            shortest=min(self._delays),
            longest=max(self._delays),
            deviation=_deviation(tuple(self._delays)),
            window=len(self._delays),
        )


def counted_rate(earlier: Endpoint, later: Endpoint) -> float | None:
    """Return the rate of an endpoint's messages, by two of its announcements [Hz].

    The messages counted between them, over the time between the last ones that each knew of; None
    where none came, or the first was the first ever.
    """
    messages, span = later.messages - earlier.messages, later.last_time - earlier.last_time
    if messages <= 0 or span <= 0 or not earlier.last_time:
        return None
    return messages * 1e9 / span


def average_rate(node: Node, endpoint: Endpoint) -> float | None:
    """Return the rate of an endpoint's messages from its node's start to the last one [Hz].

    None before two messages, or where the times do not fit.
    """
    span = endpoint.last_time - node.start_time
    if endpoint.messages < 2 or span <= 0:  # noqa: PLR2004 - an interval
        return None
    return endpoint.messages * 1e9 / span


def _deviation(values: Sequence[float]) -> float:
    """The population standard deviation."""
    mean = sum(values) / len(values)
    return sqrt(sum((value - mean) ** 2 for value in values) / len(values))
