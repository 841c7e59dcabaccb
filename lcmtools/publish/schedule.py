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


def schedule_for(
    incoming: Incoming,
    *,
    rate: float | None = None,
    count: int | None = None,
    latch: bool = False,
    keep_alive: float | None = None,
) -> Schedule:
    """Return the schedule for messages from a source; see ``publish`` for the options."""
    is_alone = incoming.is_one and not incoming.is_file and rate is None and count is None
    repeats = rate is not None or (incoming.is_file and not latch)
    usual = _TIMES_RATE if count and incoming.is_one else None
    return Schedule(
        rate=rate or (_FILE_RATE if incoming.is_file else usual),
        count=count,
        is_endless=incoming.is_one and not count and repeats,
        stay=(math.inf if latch or is_alone else 0.0) if keep_alive is None else keep_alive,
    )


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
