"""The schedule: the step at which each item is due, and the time at which a step may run.

Steps, numbered from 1, are the only time here; the wall clock comes in as a function.
"""

import math
import time
from collections.abc import Callable, Sequence
from typing import Generic, TypeVar

Item = TypeVar("Item")

MAX_DEBT = 0.25  # wall-clock seconds that the simulation may be late; further delay is dropped

_LONGEST_SLEEP = 0.1  # [s]; the longest delay of a request


class Timetable(Generic[Item]):
    """Items that are due at rates that need not divide the rate of the steps.

    The k-th time of an item is the first step at or after k / rate, so that 50 Hz on a grid of
    240 Hz is exact on average and never drifts. All items of a rate are due together. ``dt`` is the
    duration of a step [s].
    """

    def __init__(self, dt: float) -> None:
        self._dt = dt
        self._items: list[tuple[float, Item]] = []
        self._counts: dict[float, int] = {}  # how often items of each rate have been due
        self._next: float = math.inf
        """The next step at which any item is due: for most steps, this comparison is enough."""

    def add(self, rate: float, item: Item, *, after: int = 0) -> None:
        """Let ``item`` be due ``rate`` times a second, at most once per step, after this step."""
        self._items.append((rate, item))
        self._counts.setdefault(rate, self._count(after, rate))
        self._find_next()

    def remove(self, items: Sequence[Item]) -> None:
        """Remove these items."""
        self._items = [(rate, item) for rate, item in self._items if item not in items]
        self._counts = {rate: self._counts[rate] for rate, _ in self._items}
        self._find_next()

    def due(self, step: int) -> frozenset[float]:
        """Return the rates whose items are due at ``step``; steps must come in order."""
        if step < self._next:
            return frozenset()
        counts = {rate: self._count(step, rate) for rate in self._counts}
        due = frozenset(rate for rate, count in counts.items() if count > self._counts[rate])
        self._counts = counts
        self._find_next()
        return due

    def items(self, rates: frozenset[float]) -> list[Item]:
        """Return the items of these rates, in order of addition."""
        return [item for rate, item in self._items if rate in rates]

    def _count(self, step: int, rate: float) -> int:
        """Return how many times are due up to a step, including one just after it by rounding."""
        return math.floor(step * rate * self._dt * (1 + 1e-12))

    def _find_next(self) -> None:
        steps = ((n + 1) / (rate * self._dt) * (1 - 1e-12) for rate, n in self._counts.items())
        self._next = min(map(math.ceil, steps), default=math.inf)


class Pacer:
    """Lets steps run on time by the wall clock.

    Deadlines are absolute, so that a late wake-up is compensated by the following steps, which then
    run without sleeping. Delay above MAX_DEBT is dropped: the simulation falls behind instead of
    racing.
    """

    def __init__(
        self,
        period: float,
        now: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self.period = period  # wall-clock seconds per step, may be changed; 0 never waits
        self._now, self._sleep = now, sleep
        self._deadline = now()

    def restart(self) -> None:
        """Forget the elapsed time: no step is late."""
        self._deadline = self._now()

    def wait(self, go_on: Callable[[], bool], meanwhile: Callable[[], None]) -> float:
        """Wait until the next step may run, or until ``go_on`` returns False.

        ``meanwhile`` is called from time to time while the next step is far away. Returns the
        dropped delay [s], mostly 0.
        """
        if not self.period:
            return 0.0
        self._deadline += self.period
        while (ahead := self._deadline - self._now()) > 0 and go_on():
            self._sleep(min(ahead, _LONGEST_SLEEP))
            if ahead > _LONGEST_SLEEP:
                meanwhile()
        if ahead > -MAX_DEBT:
            return 0.0
        self._deadline -= ahead
        return -ahead
