"""Time as integer nanoseconds, and its sources.

Must not know messages or nodes: a node on simulated time sets a ManualClock from ``/clock``.
"""

import time
from typing import Protocol

CLOCK_TOPIC = "/clock"
"""The topic of simulated time."""
NANOSECONDS = 1_000_000_000
"""Nanoseconds in a second."""


class Clock(Protocol):
    """A source of time."""

    def now(self) -> int:
        """Return the nanoseconds since 1970 (UTC), or since the start of a simulation."""


class SystemClock:
    """The computer's clock."""

    def now(self) -> int:
        """Return the nanoseconds since 1970 (UTC)."""
        return time.time_ns()


class ManualClock:
    """A clock that is set by its user: for simulated time and for tests."""

    def __init__(self, now: int = 0) -> None:
        self._now = now

    def now(self) -> int:
        """Return the nanoseconds set last."""
        return self._now

    def set(self, now: int) -> None:
        """Set the time, in nanoseconds."""
        self._now = now


def split_stamp(nanoseconds: int) -> tuple[int, int]:
    """Convert nanoseconds into the (sec, nsec) of a message's stamp."""
    return divmod(nanoseconds, NANOSECONDS)


def join_stamp(sec: int, nsec: int) -> int:
    """Convert the (sec, nsec) of a message's stamp into nanoseconds."""
    return sec * NANOSECONDS + nsec
