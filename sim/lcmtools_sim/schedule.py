"""The schedule: the step at which each item is due, and the moment at which a step may run.

Steps are numbered from 1 and are the only time here; the wall clock comes in as a function.
"""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Generic, TypeVar

Item = TypeVar("Item")

MAX_DEBT = 0.25
"""Wall seconds that the simulation may be late before the rest is dropped."""

_LONGEST_SLEEP = 0.1  # [s]; the longest delay of a request


class Timetable(Generic[Item]):
    """Items that are due at rates which need not divide the rate of the steps.

    The k-th time of an item is the first step at or after k / rate, so that 50 Hz on a grid of
    240 Hz is exact on average and never drifts. All items of a rate are due together.

    Args:
        dt: Seconds of a step.
    """

    def __init__(self, dt: float) -> None:
        self._dt = dt
        self._groups: dict[float, _Group[Item]] = {}
        self._added = 0
        self._next: float = math.inf
        """The next step at which any item is due: most steps need not look further."""

    def add(self, rate: float, item: Item, *, after: int = 0) -> None:
        """Let ``item`` be due ``rate`` times a second, at most once a step, after a step."""
        if rate not in self._groups:
            count = math.floor(after * self._dt * rate) + 1
            while self._step(count, rate) <= after:
                count += 1
            self._groups[rate] = _Group(count, self._step(count, rate))
        self._groups[rate].items[self._added] = item
        self._added += 1
        self._find_next()

    def remove(self, items: Sequence[Item]) -> None:
        """Remove these items."""
        for rate, group in tuple(self._groups.items()):
            group.items = {n: item for n, item in group.items.items() if item not in items}
            if not group.items:
                del self._groups[rate]
        self._find_next()

    def due(self, step: int) -> list[Item]:
        """The items due at ``step``, in the order of adding; steps come in their order."""
        if step < self._next:
            return []
        found = [self._take(rate, step) for rate, g in self._groups.items() if g.step <= step]
        self._find_next()
        if len(found) < 2:  # noqa: PLR2004 - else they must be sorted
            return list(found[0].values()) if found else []
        together = {number: item for items in found for number, item in items.items()}
        return [together[number] for number in sorted(together)]

    def _take(self, rate: float, step: int) -> dict[int, Item]:
        """The items of a rate that is due at ``step``; sets the rate's next step."""
        group = self._groups[rate]
        group.count += 1
        group.step = max(step + 1, self._step(group.count, rate))
        return group.items

    def _find_next(self) -> None:
        self._next = min((group.step for group in self._groups.values()), default=math.inf)

    def _step(self, count: int, rate: float) -> int:
        # The factor keeps a value that rounding puts just above a whole step from the next one.
        return math.ceil(count / (rate * self._dt) * (1 - 1e-12))


@dataclass(slots=True)
class _Group(Generic[Item]):
    """All items of one rate, by the number of their adding; the next time's number and step."""

    count: int
    step: int
    items: dict[int, Item] = field(default_factory=dict)


class Pacer:
    """Lets steps run at their moments by the wall clock.

    Deadlines are absolute, so that a late wake-up is compensated by the following steps, which then
    run without sleeping. Debt above MAX_DEBT is dropped: the simulation falls behind instead of
    racing.

    Args:
        period: Wall seconds of a step; 0 never waits.
        now: A monotonic clock [s].
        sleep: Waits the given seconds.

    Attributes:
        period: As given; may be changed.
    """

    def __init__(
        self,
        period: float,
        now: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self.period = period
        self._now = now
        self._sleep = sleep
        self._deadline = now()

    def restart(self) -> None:
        """Forget the time that has passed: no step is late."""
        self._deadline = self._now()

    def wait(self, go_on: Callable[[], bool], meanwhile: Callable[[], None]) -> float:
        """Wait until the next step may run, or until ``go_on`` returns False.

        ``meanwhile`` is called now and then while the next step is far away. Returns the debt that
        was dropped [s], mostly 0.
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
