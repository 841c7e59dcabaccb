"""Measuring the time that callbacks take."""

import time


class Stopwatch:
    """Counts calls and the time they take: ``with stopwatch: call()``.

    One thread measures; others may read meanwhile. A nested call is counted, but its time is not
    counted twice.
    """

    def __init__(self) -> None:
        self.calls = 0
        """The number of calls that have begun."""
        self._busy = 0
        self._longest = 0
        self.began: list[int] = []
        """The times at which the running calls began [ns]."""

    def __enter__(self) -> None:
        """Begin a call."""
        self.calls += 1
        self.began.append(time.monotonic_ns())

    def __exit__(self, *_: object) -> None:
        """End a call, even if it failed."""
        self.end()

    def end(self) -> None:
        """End a call."""
        took = time.monotonic_ns() - self.began.pop()
        if took > self._longest:  # noqa: PLR1730 - half the time of ``max``
            self._longest = took
        if not self.began:
            self._busy += took

    def busy(self) -> int:
        """Return the time spent in calls, including a running one [ns]."""
        busy = self._busy  # read first: a call that ends now may be missed, not counted twice
        return busy + self._running()

    def longest(self) -> int:
        """Return the time of the longest call, including a running one [ns]."""
        return max(self._longest, self._running())

    def _running(self) -> int:
        began = self.began[:1]  # in one step: the other thread may end the call
        return time.monotonic_ns() - began[0] if began else 0
