"""The steering formula of a path follower, inferred from its poses and commands. Pure mathematics.

The turn rates of a program are compared with the angles to the next point of the path, as the right
formula and common mistakes give them. A mistake is named only if it explains the commands well, and
neither the right formula nor another mistake does.
"""

import math
from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator, Sequence

from lcmtools.labs.checks.diagnosis import velocity_of
from lcmtools.labs.checks.observations import CommandMessage, TrueState
from lcmtools.labs.checks.results import Cause

_REACHES = (0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.1)  # [m]; a nearer point is passed
_LONG_REACHES = (1.5, 2.0, 2.5, 3.5)  # [m]; what the right formula may explain is no mistake
_GOALS = 12  # of the path, to one of which a program may drive all the time
_LEAST, _ENOUGH = 50, 300  # commands
_EXPLAINS = 0.85  # agreement of a mistake that is named; 1 is the best
_MOST_OF_RIGHT = 0.8  # agreement of the right formula where a mistake is named
# Times as far from the best agreement are others than the mistake that is named, at least.
_CLEARER, _CLEARER_THAN_RIGHT = 2.0, 4.0
_FLAT = 1e-6  # rounding errors of values that are all the same

Point = tuple[float, float]
Formula = Callable[[float, float, float], float]
"""The angle to a point at (dx, dy) from the robot [m], by the robot's heading [rad]."""


def _right(dx: float, dy: float, heading: float) -> float:
    return math.atan2(dy, dx) - heading


def _opposite(dx: float, dy: float, heading: float) -> float:
    return -_right(dx, dy, heading)


_YAW = "the heading is 2*atan2(z, w) [rad]"
_RADIANS = "angles are in radians"
_MISTAKES: dict[str, Formula] = {
    "atan(dy/dx), which mistakes a point behind for one ahead: use math.atan2(dy, dx)": (
        lambda dx, dy, heading: math.atan(dy / dx if dx else math.inf) - heading
    ),
    "atan2(dx, dy), in which x and y are exchanged: use math.atan2(dy, dx)": (
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
    points: Sequence[Point], states: Sequence[TrueState], commands: Sequence[CommandMessage]
) -> Cause | None:
    """Return the mistake in the steering angle; None if it is unclear."""
    moments = list(_moments(states, commands))
    if len(moments) < _LEAST:
        return None
    seen, turns = [state for state, _ in moments], [math.tanh(turn) for _, turn in moments]

    def fit(formula: Formula, *goals: tuple[Sequence[Point], float]) -> float:
        return _agreement(formula, [list(_ways(p, seen, reach)) for p, reach in goals], turns)

    usual = [(points, reach) for reach in _REACHES]
    scores = {text: fit(formula, *usual) for text, formula in _MISTAKES.items()}
    scores[_EXCHANGED] = fit(_right, *(([(y, x) for x, y in points], r) for r in _REACHES))
    best, second = sorted(scores, key=scores.__getitem__, reverse=True)[:2]
    always_one = (([one], 0.0) for one in points[:: max(1, len(points) // _GOALS)])
    rival = max(scores[second], fit(_opposite, *usual), fit(_right, *always_one))
    lack = 1 - scores[best]
    if not (scores[best] >= _EXPLAINS and 1 - rival >= _CLEARER * lack):  # as NaN is neither
        return None
    ways = ((p, r) for p in (points, points[::-1]) for r in (*_REACHES, *_LONG_REACHES))
    is_right = fit(_right, *ways) > min(_MOST_OF_RIGHT, 1 - _CLEARER_THAN_RIGHT * lack)
    return None if is_right else Cause("angle", f"its turns fit {best}")


def _moments(
    states: Sequence[TrueState], commands: Sequence[CommandMessage]
) -> Iterator[tuple[TrueState, float]]:
    """Yield turn rates of some commands [rad/s], each with the robot's state at that time."""
    times = [state.time for state in states]
    # a log may go on when the robot has long left the path
    during = [command for command in commands if times and times[0] <= command.time <= times[-1]]
    for command in during[:: max(1, len(during) // _ENOUGH)]:
        state = states[bisect_right(times, command.time) - 1]
        velocity = velocity_of(command.message)
        if velocity and math.isfinite(velocity[1] + state.x + state.y + state.heading):
            yield state, velocity[1]


def _ways(
    points: Sequence[Point], states: Iterable[TrueState], reach: float
) -> Iterator[tuple[float, float, float]]:
    """Yield (dx, dy) to the first point ahead [m], and the heading [rad]."""
    number = 0
    for state in states:
        while number < len(points) - 1 and math.dist(points[number], (state.x, state.y)) < reach:
            number += 1
        x, y = points[number]
        yield x - state.x, y - state.y, state.heading


def _agreement(
    formula: Formula, ways: Sequence[Sequence[tuple[float, float, float]]], turns: Sequence[float]
) -> float:
    """Return the agreement of turns with a formula's angles, -1 to 1, at the best reach.

    A program may or may not wrap the angle to -pi and pi. Turning the same way all the time proves
    nothing, so the correlation counts as well as the cosine.
    """
    best = -1.0
    for way in ways:
        angles = [formula(*one) for one in way]
        for kept in ([math.remainder(angle, math.tau) for angle in angles], angles):
            bounded = [max(-1.0, min(1.0, angle)) for angle in kept]
            score = min(_cosine(bounded, turns), _cosine(_centred(bounded), _centred(turns)))
            best = max(best, score)
    return best


def _centred(values: Sequence[float]) -> list[float]:
    mean = math.fsum(values) / len(values)
    return [value - mean for value in values]


def _cosine(a: Sequence[float], b: Sequence[float]) -> float:
    size = math.hypot(*a) * math.hypot(*b)
    return math.fsum(x * y for x, y in zip(a, b, strict=True)) / size if size > _FLAT else 0.0
