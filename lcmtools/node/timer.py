"""Timers."""

from collections.abc import Callable

from lcmtools.clock import NANOSECONDS

NEVER = (1 << 63) - 1
"""The time of a call that does not come."""


class Timer:
    """Calls a function at a fixed rate. Made by ``Node.create_timer``.

    Calls stay on the time grid that begins with the timer's creation: a late call does not delay
    the next one, and missed periods are skipped. The period [s] is positive and finite; ``clock``
    returns the current time [ns], and times passed to the methods are of the same clock.
    """

    def __init__(
        self, seconds: float, callback: Callable[[], object], clock: Callable[[], int]
    ) -> None:
        self.callback = callback
        self.period = max(1, round(seconds * NANOSECONDS))
        self._clock = clock
        self._next = clock() + self.period
        self._cancelled = False

    def __str__(self) -> str:
        """Return its name, for the list of a node's errors."""
        return f"timer {self.period / NANOSECONDS:g} s"

    def cancel(self) -> None:
        """Stop calling."""
        self._cancelled = True

    def reset(self) -> None:
        """Start again, with the next call one period from now; also after ``cancel``."""
        self._cancelled = False
        self._next = self._clock() + self.period

    def is_due(self, now: int) -> bool:
        """Return whether it is time to call."""
        if now < self._next - self.period:  # simulated time was set back
            self._next = now + self.period
        return not self._cancelled and now >= self._next

    def advance(self, now: int) -> None:
        """Schedule the next call, and skip periods that have passed."""
        missed = (now - self._next) // self.period
        self._next += (missed + 1) * self.period

    def due(self) -> int:
        """Return the time of the next call [ns]; ``NEVER`` if it is cancelled."""
        return NEVER if self._cancelled else self._next

    def remaining(self, now: int) -> float | None:
        """Return the time until the next call [s]; None if it is cancelled."""
        return None if self._cancelled else max(0, self._next - now) / NANOSECONDS
