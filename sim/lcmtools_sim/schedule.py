"""When things happen: which step publishes what, and at which moment a step may run.

Steps are numbered from 1 and are the only time here; the wall clock comes in as a function.
"""

import heapq
import math
import time
from collections.abc import Callable, Sequence
from typing import Generic, TypeVar

Item = TypeVar("Item")

MAX_DEBT = 0.25
"""Wall seconds that the simulation may be late before the rest is dropped."""

_LONGEST_SLEEP = 0.1  # [s]; how long a request to stop may go unnoticed


class Timetable(Generic[Item]):
    """Items that are due at rates which need not divide the rate of the steps.

    The k-th time an item is due is the first step at or after k / rate, so that 50 Hz on a grid
    of 240 Hz is exact on average and never drifts.

    Args:
        dt: Seconds of a step.
    """

    def __init__(self, dt: float) -> None:
        self._dt = dt
        self._next: list[tuple[int, int, int]] = []  # step, place in _items, count
        self._items: list[tuple[float, Item]] = []

    def add(self, rate: float, item: Item, *, after: int = 0) -> None:
        """Let ``item`` be due ``rate`` times a second, at most once a step, from ``after`` on."""
        count = math.floor(after * self._dt * rate) + 1
        while self._step(count, rate) <= after:
            count += 1
        self._items.append((rate, item))
        heapq.heappush(self._next, (self._step(count, rate), len(self._items) - 1, count))

    def remove(self, items: Sequence[Item]) -> None:
        """Let these be due no more."""
        gone = {place for place, (_, item) in enumerate(self._items) if item in items}
        self._next = [entry for entry in self._next if entry[1] not in gone]
        heapq.heapify(self._next)

    def due(self, step: int) -> list[Item]:
        """What is due at ``step``, in the order of adding; steps are asked for in their order."""
        found = []
        while self._next and self._next[0][0] <= step:
            _, place, count = self._next[0]
            rate, item = self._items[place]
            found.append(item)
            following = max(step + 1, self._step(count + 1, rate))
            heapq.heapreplace(self._next, (following, place, count + 1))
        return found

    def _step(self, count: int, rate: float) -> int:
        # The factor keeps what rounding puts just above a whole step from going to the next.
        return math.ceil(count / (rate * self._dt) * (1 - 1e-12))


class Pacer:
    """Lets steps run at their moments by the wall clock.

    Deadlines are absolute, so that a late wake-up is made good by the following steps, which then
    run without sleeping. What is later than MAX_DEBT is dropped: the simulation falls behind
    instead of racing.

    Args:
        period: Wall seconds of a step; 0 never waits.
        now: A monotonic clock [s].
        sleep: Waits the seconds given.
    """

    def __init__(
        self,
        period: float,
        now: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self._period = period
        self._now = now
        self._sleep = sleep
        self._deadline = now()

    def wait(self, go_on: Callable[[], bool]) -> float:
        """Wait until the next step may run, or until ``go_on`` says no.

        Returns:
            The debt that was dropped [s], mostly 0.
        """
        if not self._period:
            return 0.0
        self._deadline += self._period
        while (ahead := self._deadline - self._now()) > 0 and go_on():
            self._sleep(min(ahead, _LONGEST_SLEEP))
        if ahead > -MAX_DEBT:
            return 0.0
        self._deadline -= ahead
        return -ahead
