"""What tyres do to a robot's body, as plain mathematics of the plane that it stands on.

It knows no engine: what Bullet computed comes in, what the tyres make of it goes out.

The robot stands on two ideal wheels at its effective track, which makes it an exact differential
drive; each tyre gives at most what Coulomb friction allows. skid.py has the other kind, with all
wheels where they are.

This runs in every step for every robot, so constants are worked out beforehand and numbers are
handed on one by one: a step of the engine itself takes little more time.
"""

import math
from collections.abc import Callable

from lcmtools_sim.drive import SideSpeeds
from lcmtools_sim.robots.model import RobotModel

Tyres = Callable[[float, float, float, SideSpeeds, float], tuple[float, float, float]]
"""How the tyres change a body's velocity in one step.

Takes its velocity before, in its own frame: forward [m/s], to the left [m/s] and turn rate [rad/s];
the ground speeds of its wheels; and the largest impulse of a side, friction times load times step
[N s]. Gives the changes of the three.
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
    """The factor that brings an impulse down to the largest possible one."""
    impulse = math.hypot(along, across)
    return 1.0 if impulse <= largest else largest / impulse
