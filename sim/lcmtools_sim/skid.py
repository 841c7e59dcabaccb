"""How a robot on four fixed wheels turns: by skidding, as Coulomb friction has it.

Each wheel pulls its contact towards its own speed with an impulse of at most friction times load
times step, in any direction of the plane. What the four together do is found by projected
Gauss-Seidel sweeps (R. Cottle et al., The Linear Complementarity Problem, chapter 5). On the spot,
with wheels at (+-a, +-b), the balance of moments gives b^2 / (a^2 + b^2) of the turn rate that the
same wheels would have without skidding; tests hold it to that.
"""

import math
from collections.abc import Sequence

from lcmtools_sim.drive import SideSpeeds
from lcmtools_sim.robots.model import RobotModel
from lcmtools_sim.tyres import Tyres

_SWEEPS = 6


def skidding(model: RobotModel) -> Tyres:
    """The wheels of a model, each where it touches the ground."""
    wheels = model.drive.wheels
    mass, inertia = model.body.mass, model.body.inertia[2]
    gain = _gain(wheels, mass, inertia)

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


def _gain(wheels: Sequence[tuple[float, float]], mass: float, inertia: float) -> float:
    """Impulse for a slip of 1 m/s, the same in all directions, so that none is preferred [kg]."""
    farthest = max(x * x + y * y for x, y in wheels)
    return 1 / (1 / mass + farthest / inertia)
