"""The forces of tyres on a robot's body, in the plane on which it stands.

No engine is known here: the body's velocity comes in, the change made by the tyres goes out. There
are two models, both with Coulomb friction:

- gripping: two ideal wheels at the effective track, which form an exact differential drive.
- skidding: four fixed wheels at their positions, which turn the robot by skidding. Each pulls its
  contact towards its own speed with an impulse of at most friction times load times step, in any
  direction of the plane. The balance of all is found by projected Gauss-Seidel sweeps (R. Cottle
  et al., The Linear Complementarity Problem, chapter 5). On the spot, with wheels at (+-a, +-b),
  the balance of moments gives b^2 / (a^2 + b^2) of the turn rate without skidding; this is tested.

A Value may be an array, for many robots.
"""

from collections.abc import Callable, Sequence

from lcmtools_sim.arithmetic import Arithmetic, Value
from lcmtools_sim.geometry import Vector

_SWEEPS = 6
_TINY = 1e-300  # [N s] in place of 0 as a divisor

Tyres = Callable[[Value, Value, Value, Value, Value, Value], Vector]
"""Returns the change of a body's velocity made by its tyres in one step.

Takes the velocity before, in the body's frame: forward [m/s], to the left [m/s] and turn rate
[rad/s]; the ground speeds of the left and the right wheels; and the largest impulse of a side,
friction times load times step [N s]. Returns the changes of the three.
"""


def gripping(mass: Value, inertia: Value, track: Value, ops: Arithmetic) -> Tyres:
    """Return the tyres of two ideal wheels.

    Without slip, a tyre gives the impulse that makes the ground speed at its contact equal to the
    wheel's; with slip, it gives the largest impulse in that direction.
    """
    half_mass, inertia_by_track = mass / 2, inertia / track
    minimum, maximum, hypot = ops.minimum, ops.maximum, ops.hypot

    def pull(
        forward: Value, sideways: Value, turn_rate: Value, left: Value, right: Value, largest: Value
    ) -> Vector:
        along = half_mass * ((left + right) / 2 - forward)
        twist = inertia_by_track * ((right - left) / track - turn_rate)
        across = -half_mass * sideways
        of_left, of_right = along - twist, along + twist
        left_grip = minimum(1.0, largest / maximum(hypot(of_left, across), _TINY))
        right_grip = minimum(1.0, largest / maximum(hypot(of_right, across), _TINY))
        of_left, of_right = of_left * left_grip, of_right * right_grip
        return (
            (of_left + of_right) / mass,
            (left_grip + right_grip) * across / mass,
            (of_right - of_left) / 2 / inertia_by_track,
        )

    return pull


def skidding(
    mass: Value, inertia: Value, wheels: Sequence[tuple[float, float]], ops: Arithmetic
) -> Tyres:
    """Return the tyres of wheels with their contacts at (x, y) in the body's frame [m]."""
    farthest = max(x * x + y * y for x, y in wheels)
    gain = 1 / (1 / mass + farthest / inertia)
    """Impulse for a slip of 1 m/s, equal in all directions, so that none is preferred [kg]."""

    def pull(
        forward: Value, sideways: Value, turn_rate: Value, left: Value, right: Value, largest: Value
    ) -> Vector:
        before = forward, sideways, turn_rate
        limit = 2 * largest / len(wheels)
        impulses: list[tuple[Value, Value]] = [(0.0, 0.0)] * len(wheels)
        for _ in range(_SWEEPS):
            for i, (x, y) in enumerate(wheels):
                along, across = impulses[i]
                trial_along = along - gain * (forward - turn_rate * y - (left if y > 0 else right))
                trial_across = across - gain * (sideways + turn_rate * x)
                length = ops.maximum(ops.hypot(trial_along, trial_across), _TINY)
                factor = ops.minimum(1.0, limit / length)
                new = trial_along * factor, trial_across * factor
                change_along, change_across = new[0] - along, new[1] - across
                forward = forward + change_along / mass
                sideways = sideways + change_across / mass
                turn_rate = turn_rate + (x * change_across - y * change_along) / inertia
                impulses[i] = new
        return forward - before[0], sideways - before[1], turn_rate - before[2]

    return pull
