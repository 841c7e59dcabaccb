"""Step responses: how a measured value follows a wanted one. Pure numbers.

The measures are those of any control course: the settling time is when the value enters a band
around the target for the last time; the overshoot is how far beyond the target it was.
"""

import statistics
from collections.abc import Sequence
from dataclasses import dataclass

BAND = 0.05
"""Within this part of the target it counts as reached."""
_LAST = 1.0  # [s] whose mean is the value reached


@dataclass(frozen=True, slots=True)
class Response:
    """The response to a step.

    Attributes:
        reached: Mean of the last second, in the value's unit.
        settled_after: [s] until it stays within the band; None when it does not.
        overshoot: Beyond the target, as a part of the step; 0 when it never was.
    """

    reached: float
    settled_after: float | None
    overshoot: float


def analyse(samples: Sequence[tuple[float, float]], target: float) -> Response:
    """The response in samples of (time since the step [s], value); there is at least one.

    Args:
        samples: In order of time.
        target: What was wanted, not 0.
    """
    end = samples[-1][0]
    reached = statistics.fmean(value for time, value in samples if time >= end - _LAST)
    beyond = max((value - target) / target for _, value in samples)
    return Response(reached, _settled_after(samples, target), max(0.0, beyond))


def is_within(value: float, target: float) -> bool:
    """Return whether a value is within the band around the target."""
    return abs(value - target) <= BAND * abs(target)


def _settled_after(samples: Sequence[tuple[float, float]], target: float) -> float | None:
    settled: float | None = None
    for time, value in samples:
        if not is_within(value, target):
            settled = None
        elif settled is None:
            settled = time
    return settled
