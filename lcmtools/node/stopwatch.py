"""Measuring the time that callbacks take."""

import time


class Stopwatch:
    """Counts calls and the time they take: ``with stopwatch: call()``.

    One thread measures; any other may read meanwhile. A call within a call counts, its time does
    not count twice.
    """

    def __init__(self) -> None:
        self.calls = 0
        """The number of calls that have begun."""
        self._busy = 0
        self._longest = 0
        self._began: list[int] = []

    def __enter__(self) -> None:
        """Begin a call."""
        self.calls += 1
        self._began.append(time.monotonic_ns())

    def __exit__(self, *_: object) -> None:
        """End a call, perhaps by an error."""
        took = time.monotonic_ns() - self._began.pop()
        self._longest = max(self._longest, took)
        if not self._began:
            self._busy += took

    def busy(self) -> int:
        """Return the time spent in calls, in one that runs too [ns]."""
        busy = self._busy  # before the rest: a call that ends now is missed once, never twice
        return busy + self._running()

    def longest(self) -> int:
        """Return the time of the longest call, of one that runs too [ns]."""
        return max(self._longest, self._running())

    def _running(self) -> int:
        began = self._began[:1]  # in one step: the other thread may end the call
        return time.monotonic_ns() - began[0] if began else 0
