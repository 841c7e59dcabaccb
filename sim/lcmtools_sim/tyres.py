"""The forces of tyres on a robot's body, in the plane that it stands on.

No engine is known here: Bullet's result comes in, the tyres' change of it goes out. There are two
models, both with Coulomb friction:

- gripping: two ideal wheels at the effective track, which make an exact differential drive.
- skidding: four fixed wheels at their places, which turn the robot by skidding. Each pulls its
  contact towards its own speed with an impulse of at most friction times load times step, in any
  direction of the plane. The balance of all is found by projected Gauss-Seidel sweeps (R. Cottle
  et al., The Linear Complementarity Problem, chapter 5). On the spot, with wheels at (+-a, +-b),
  the balance of moments gives b^2 / (a^2 + b^2) of the turn rate without skidding; tests hold it.

This runs in every step for every robot, so constants are computed before and numbers are passed
one by one: a step of the engine itself takes little more time.
"""

import math
from collections.abc import Callable

from lcmtools_sim.drive import SideSpeeds
from lcmtools_sim.robots.model import RobotModel

_SWEEPS = 6

Tyres = Callable[[float, float, float, SideSpeeds, float], tuple[float, float, float]]
"""The change of a body's velocity by its tyres in one step.

Takes the velocity before, in the body's frame: forward [m/s], to the left [m/s] and turn rate
[rad/s]; the ground speeds of the wheels; and the largest impulse of a side, friction times load
times step [N s]. Returns the changes of the three.
"""


def gripping(model: RobotModel) -> Tyres:
    """Two ideal wheels.

    Without slip a tyre gives the impulse that makes the ground speeds at its contact those of the
    wheel; with slip it gives the largest one in that direction.
    """
    mass, inertia, track = model.body.mass, model.body.inertia[2], model.drive.track
    half_mass, inertia_by_track = mass / 2, inertia / track

    def pull(
        forward: float, sideways: float, turn_rate: float, speeds: SideSpeeds, largest: float
    ) -> tuple[float, float, float]:
        left_speed, right_speed = speeds
        missing = (left_speed + right_speed) / 2 - forward
        missing_turn = (right_speed - left_speed) / track - turn_rate
        along, across = half_mass * missing, -half_mass * sideways
        twist = inertia_by_track * missing_turn
        greater = abs(along) + abs(twist)  # of the two sides
        if greater * greater + across * across <= largest * largest:
            return missing, -sideways, missing_turn
        left = _slip(along - twist, across, largest)
        right = _slip(along + twist, across, largest)
        along_left, along_right = left * (along - twist), right * (along + twist)
        return (
            (along_left + along_right) / mass,
            (left + right) * across / mass,
            (along_right - along_left) * track / 2 / inertia,
        )

    return pull


def _slip(along: float, across: float, largest: float) -> float:
    """The factor that reduces an impulse to the largest possible one."""
    impulse = math.hypot(along, across)
    return 1.0 if impulse <= largest else largest / impulse


def skidding(model: RobotModel) -> Tyres:
    """The wheels of a model, each at its contact with the ground."""
    wheels = model.drive.wheels
    mass, inertia = model.body.mass, model.body.inertia[2]
    farthest = max(x * x + y * y for x, y in wheels)
    gain = 1 / (1 / mass + farthest / inertia)
    """Impulse for a slip of 1 m/s, the same in all directions, so that none is preferred [kg]."""

    def pull(
        forward: float, sideways: float, turn_rate: float, speeds: SideSpeeds, largest: float
    ) -> tuple[float, float, float]:
        before = forward, sideways, turn_rate
        limit = 2 * largest / len(wheels)
        impulses = [(0.0, 0.0)] * len(wheels)
        for _ in range(_SWEEPS):
            for i, (x, y) in enumerate(wheels):
                wheel = speeds.left if y > 0 else speeds.right
                along, across = impulses[i]
                trial_along = along - gain * (forward - turn_rate * y - wheel)
                trial_across = across - gain * (sideways + turn_rate * x)
                factor = limit / max(limit, math.hypot(trial_along, trial_across))
                new = trial_along * factor, trial_across * factor
                change_along, change_across = new[0] - along, new[1] - across
                forward += change_along / mass
                sideways += change_across / mass
                turn_rate += (x * change_across - y * change_along) / inertia
                impulses[i] = new
        return forward - before[0], sideways - before[1], turn_rate - before[2]

    return pull
