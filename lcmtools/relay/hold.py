"""When a relay may begin to carry messages, so that none is duplicated or overtaken. Pure.

A relay waits for a moment, to hear of other relays first. Over a line, their reports may come late:
a relay that hears others on one bus but none over the line may be parallel to one of them, and
waits as long as it takes to detect a dead line. A relay that takes over waits until everything that
the other relay sent must have arrived; what arrives even later is dropped.
"""

from collections.abc import Iterable

from lcmtools.graph.relay_report import Link, State
from lcmtools.relay.fair_queue import LATE

_HOLD = 0.7  # [s]
_DEAF = 5.0  # [s]; Zenoh detects a dead line in 4 (``bus.zenoh.config``), a server in about 1
_HANDOVER = LATE + 0.2  # [s]


class Hold:
    """The time before a relay may begin to carry; times are ``time.monotonic()`` [s].

    Args:
        lines: The ids of the relay's ends over which messages may come late.
        now: The current time.
    """

    def __init__(self, lines: Iterable[str], now: float) -> None:
        self._lines = frozenset(lines)
        self._active: frozenset[str] = frozenset()
        self._deaf = ""
        self.begin(now)

    def begin(self, now: float) -> None:
        """Start waiting, because a bus was lost or restored."""
        self._until, self._deaf_until = now + _HOLD, now + _DEAF

    def update(self, links: tuple[Link, ...], active: frozenset[str], now: float) -> None:
        """Update from all relays, this one first, and the ids of those that should now carry."""
        own, *others = links
        deaf = {end.id for end in own.ends if not end.heard}
        self._deaf = deaf.pop() if len(deaf) == 1 and deaf <= self._lines else ""
        if not self._deaf:
            self._deaf_until = now + _DEAF
        relieved = self._active - active
        if any(one.id in relieved and one.state is State.ACTIVE for one in others):
            self._until = max(self._until, now + _HANDOVER)
        self._active = active

    def lasts(self, now: float) -> bool:
        """Return whether the relay must wait."""
        return now < (max(self._until, self._deaf_until) if self._deaf else self._until)

    def awaited(self, now: float) -> str:
        """Return the id of the line if the relay waits only for others on it, else ""."""
        return self._deaf if self._until <= now < self._deaf_until else ""
