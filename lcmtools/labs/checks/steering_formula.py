"""The steering formula of a path follower, inferred from its poses and commands. Pure mathematics.

The turn rates of a program are compared with the angles to the next point of the path, as the right
formula and common mistakes give them. A mistake is named only if it explains the commands well, and
neither the right formula nor another mistake does.
"""

import math
from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import lru_cache, partial

from lcmtools.labs.checks.diagnosis import velocity_of
from lcmtools.labs.checks.observations import ReceivedMessage, TrueState
from lcmtools.labs.checks.results import Cause

ANGLE = "angle"  # the key of the cause
_REACHES = (0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.1)  # [m]; a nearer point is passed
_LONG_REACHES = (1.5, 2.0, 2.5, 3.5)  # [m]; what the right formula may explain is no mistake
_GOALS = 12  # of the path, to one of which a program may drive all the time
_LEAST, _ENOUGH = 50, 300  # commands
_EXPLAINS = 0.85  # agreement of a mistake that is named; 1 is the best
_MOST_OF_RIGHT = 0.8  # agreement of the right formula where a mistake is named
# Times as far from the best agreement are others than the mistake that is named, at least.
_CLEARER, _CLEARER_THAN_RIGHT = 2.0, 4.0
_LATE = 0, 2, 4, 8
"""States before a command, from one of which it may be: the first number that is clear counts.

A program or this check that waits for the processor is late, and the heading in degrees of 20 ms
earlier is another one altogether.
"""
_FLAT = 1e-6  # rounding errors of values that are all the same

Point = tuple[float, float]
Way = tuple[float, float, float]
Formula = Callable[[float, float, float], float]
"""The angle to a point at (dx, dy) from the robot [m], by the robot's heading [rad]."""


def _right(dx: float, dy: float, heading: float) -> float:
    return math.atan2(dy, dx) - heading


def _opposite(dx: float, dy: float, heading: float) -> float:
    return -_right(dx, dy, heading)


_YAW = "the heading is 2*atan2(z, w) [rad]"
_RADIANS = "angles are in radians"
_MISTAKES: dict[str, Formula] = {
    "atan(dy/dx), which mistakes a point behind for one ahead: use atan2(dy, dx)": (
        lambda dx, dy, heading: math.atan(dy / dx if dx else math.inf) - heading
    ),
    "atan2(dx, dy), in which x and y are exchanged: use atan2(dy, dx)": (
        lambda dx, dy, heading: math.atan2(dx, dy) - heading
    ),
    f"orientation.z in place of the heading: {_YAW}": (
        lambda dx, dy, heading: _right(dx, dy, math.sin(heading / 2))
    ),
    f"half of the heading: {_YAW}": lambda dx, dy, heading: _right(dx, dy, heading / 2),
    "the direction to the point alone: subtract the robot's heading": (
        lambda dx, dy, _: _right(dx, dy, 0.0)
    ),
    f"a heading in degrees: {_RADIANS}": (
        lambda dx, dy, heading: _right(dx, dy, math.degrees(heading))
    ),
    f"a direction to the point in degrees: {_RADIANS}": (
        lambda dx, dy, heading: math.degrees(math.atan2(dy, dx)) - heading
    ),
}
_EXCHANGED = "points whose x and y are exchanged: a point is at (position.x, position.y)"


def steering_cause(
    points: Sequence[Point], states: Sequence[TrueState], commands: Sequence[ReceivedMessage]
) -> Cause | None:
    """Return the mistake in the steering angle; None if it is unclear."""
    moments = list(_moments(states, commands))
    if len(moments) < _LEAST:
        return None
    turns = [math.tanh(turn) for _, turn in moments]
    ways = lru_cache(None)(lambda goals, reach: list(_ways(goals, states, reach)))
    for late in _LATE:
        windows = [(max(0, number - late), number + 1) for number, _ in moments]
        if cause := _clear_mistake(points, ways, partial(_agreement, windows, turns)):
            return cause
    return None


def _clear_mistake(
    points: Sequence[Point],
    ways: Callable[[tuple[Point, ...], float], Sequence[Way]],
    agreement: Callable[[Formula, Sequence[Way]], float],
) -> Cause | None:
    """Return the mistake that explains the turns well, if nothing else does."""

    def fit(formula: Formula, *goals: tuple[Iterable[Point], float]) -> float:
        return max(agreement(formula, ways(tuple(path), reach)) for path, reach in goals)

    usual = [(points, reach) for reach in _REACHES]
    scores = {text: fit(formula, *usual) for text, formula in _MISTAKES.items()}
    scores[_EXCHANGED] = fit(_right, *(([(y, x) for x, y in points], r) for r in _REACHES))
    best, second = sorted(scores, key=scores.__getitem__, reverse=True)[:2]
    lack = 1 - scores[best]
    if not (scores[best] >= _EXPLAINS and 1 - scores[second] >= _CLEARER * lack):  # as NaN is
        return None
    always_one = (([one], 0.0) for one in points[:: max(1, len(points) // _GOALS)])
    if 1 - max(fit(_opposite, *usual), fit(_right, *always_one)) < _CLEARER * lack:
        return None
    every = ((p, r) for p in (points, points[::-1]) for r in (*_REACHES, *_LONG_REACHES))
    is_right = fit(_right, *every) > min(_MOST_OF_RIGHT, 1 - _CLEARER_THAN_RIGHT * lack)
    return None if is_right else Cause(ANGLE, f"its turns fit {best}")


def _moments(
    states: Sequence[TrueState], commands: Sequence[ReceivedMessage]
) -> Iterator[tuple[int, float]]:
    """Yield turn rates of some commands [rad/s], each with the index of the state at that time."""
    times = [state.time for state in states]
    # a log may go on when the robot has long left the path
    during = [command for command in commands if times and times[0] <= command.time <= times[-1]]
    for command in during[:: max(1, len(during) // _ENOUGH)]:
        number = bisect_right(times, command.time) - 1
        state, velocity = states[number], velocity_of(command.message)
        if velocity and math.isfinite(velocity[1] + state.x + state.y + state.heading):
            yield number, velocity[1]


def _ways(points: Sequence[Point], states: Iterable[TrueState], reach: float) -> Iterator[Way]:
    """Yield (dx, dy) to the first point ahead [m], and the heading [rad], for each state."""
    number = 0
    for state in states:
        while number < len(points) - 1 and math.dist(points[number], (state.x, state.y)) < reach:
            number += 1
        x, y = points[number]
        yield x - state.x, y - state.y, state.heading


def _agreement(
    windows: Sequence[tuple[int, int]],
    turns: Sequence[float],
    formula: Formula,
    ways: Sequence[Way],
) -> float:
    """Return the agreement of turns with a formula's angles, -1 to 1.

    Each turn is compared with the nearest of the angles in its window of states. A program may or
    may not wrap the angle to -pi and pi. Turning the same way all the time proves nothing, so the
    correlation counts as well as the cosine.
    """
    best, angles = -1.0, [formula(*way) for way in ways]
    for kept in ([math.remainder(angle, math.tau) for angle in angles], angles):
        bounded = [max(-1.0, min(1.0, angle)) for angle in kept]
        chosen = [
            _nearest(bounded[start:end], turn)
            for (start, end), turn in zip(windows, turns, strict=True)
        ]
        score = min(_cosine(chosen, turns), _cosine(_centred(chosen), _centred(turns)))
        best = max(best, score)
    return best


def _nearest(values: Sequence[float], wanted: float) -> float:
    return min(values, key=lambda value: abs(value - wanted))


def _centred(values: Sequence[float]) -> list[float]:
    mean = math.fsum(values) / len(values)
    return [value - mean for value in values]


def _cosine(a: Sequence[float], b: Sequence[float]) -> float:
    size = math.hypot(*a) * math.hypot(*b)
    return math.fsum(x * y for x, y in zip(a, b, strict=True)) / size if size > _FLAT else 0.0
