"""When messages and requests are sent: by options, and by where they come from.

Belongs here: the rules of rostopic and ros2. Must not know how anything is sent.
"""

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass

from lcmtools.publish.incoming import Incoming

_FILE_RATE = 10.0  # [Hz], as rostopic
_TIMES_RATE = 1.0  # [Hz], as ros2


@dataclass(frozen=True, slots=True, kw_only=True)
class Schedule:
    """When messages are sent.

    Attributes:
        rate: [Hz]; None for as they come.
        count: How many; None for all.
        is_endless: Start again after the last one.
        stay: How long to stay after the last [s], for late subscribers.
    """

    rate: float | None = None
    count: int | None = None
    is_endless: bool = False
    stay: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class PublishOptions:
    """When to send, as far as it is given; see ``publish``."""

    rate: float | None = None
    count: int | None = None
    latch: bool = False
    keep_alive: float | None = None

    def schedule(self, incoming: Incoming) -> Schedule:
        """Return the schedule for messages from this source."""
        repeats = self.rate is not None or (incoming.is_file and not self.latch)
        usual = _TIMES_RATE if self.count and incoming.is_one else None
        return Schedule(
            rate=self.rate or (_FILE_RATE if incoming.is_file else usual),
            count=self.count,
            is_endless=incoming.is_one and not self.count and repeats,
            stay=self._stay(incoming),
        )

    def _stay(self, incoming: Incoming) -> float:
        """A single message that is not from a file is latched unless another option is given."""
        if self.keep_alive is not None:
            return self.keep_alive
        is_alone = incoming.is_one and not incoming.is_file
        latches = self.latch or (is_alone and self.rate is None and self.count is None)
        return math.inf if latches else 0.0


def due_times(rate: float | None, most_behind: float = 0.0) -> Iterator[float]:
    """The times [s, monotonic] at which to send, from now on; take each when the last has gone.

    Args:
        rate: [Hz]; None for at once.
        most_behind: Delay [s] that is made up for; after a longer one the rest is postponed.
    """
    period = 1 / rate if rate else 0.0
    due = time.monotonic()
    while True:
        yield due
        behind = time.monotonic() - due - period
        due += period + (behind if behind > most_behind else 0.0)
