"""Robots that the engine moves: how their tyres pull them, also for many at once, with arrays.

Robots' measurements and commands are not known here.
"""

from collections.abc import Sequence

import numpy as np

from lcmtools_sim.arithmetic import Value, arithmetic_of
from lcmtools_sim.engines.engine import Motion
from lcmtools_sim.geometry import Vector, add, axes, components, dot, multiply, scaled, subtract
from lcmtools_sim.sensors.sensor import RobotState
from lcmtools_sim.tyres import Tyres
from lcmtools_sim.vehicles import Constants, Vehicles, measured
from lcmtools_sim.world import World

_LIFTING_OFF = 0.2  # [m/s] along its own up axis: a robot on its wheels does not move along it
_UPRIGHT = 0.5  # cosine of the tilt; beyond this tilt, no wheel reaches the ground


def pulled(
    motion: Motion,
    sides: tuple[Value, Value],
    constants: Constants,
    tyres: Tyres,
    times: tuple[float, float],
) -> tuple[Vector, Vector]:
    """Return velocity and angular velocity in the world after the tyres' pull.

    The pull acts along the heading in the middle of the step, so that the engine's straight steps
    are the chords of the robot's arc. It compensates the effect of gravity in this step; otherwise,
    the robot would creep down every slope. On a slope, the wheels carry less.

    Args:
        motion: Motion of a robot, or of many as arrays.
        sides: The speeds of the left and the right wheels [m/s].
        constants: Constants of the robot, or of all.
        tyres: Tyres of the robot, or of all.
        times: Duration of a step [s], and the speed that a falling body gains in it [m/s].
    """
    (left, right), (dt, fall), velocity = sides, times, motion.velocity
    ops = arithmetic_of(constants.mass)
    quarter_turn = (right - left) / constants.track * dt / 4
    mid_turn = 0.0, 0.0, ops.sin(quarter_turn), ops.cos(quarter_turn)
    frame = axes(multiply(motion.rotation, mid_turn))
    up = frame[2]
    stands = (up[2] >= _UPRIGHT) & (ops.absolute(dot(velocity, up)) <= _LIFTING_OFF)
    forward, sideways, _ = components(subtract(velocity, (0.0, 0.0, fall)), frame)
    turn_rate = dot(motion.angular_velocity, up)
    largest = constants.largest_impulse * up[2] * stands
    along, across, twist = tyres(forward, sideways, turn_rate, left, right, largest)
    pull = add(scaled(frame[0], along), scaled(frame[1], across))
    return add(velocity, pull), add(motion.angular_velocity, scaled(up, twist))


class RobotsInEngine:
    """Many robots that the engine moves.

    Args:
        world: The engine's world.
        vehicles: Has the robots' values.
        robots: For each, its index in ``vehicles``, its body, and its motion now and one step ago.
        fall: The speed that a falling body gains in a step [m/s].
    """

    def __init__(
        self,
        world: World,
        vehicles: Vehicles,
        robots: Sequence[tuple[int, int, tuple[Motion, Motion]]],
        fall: float,
    ) -> None:
        indices, self._bodies, motions = zip(*robots, strict=True)
        self._world, self._vehicles, self._fall = world, vehicles, fall
        self._indices = np.array(indices)
        self._constants, _ = vehicles.take(self._indices)
        self._tyres = vehicles.tyres_of(self._constants)
        self._motion, self._before = map(_stacked, zip(*motions, strict=True))

    def pull(self) -> None:
        """Let the wheels pull the bodies, before the engine's step."""
        now, indices = self._vehicles.now, self._indices
        sides = now.left[indices], now.right[indices]  # type: ignore[index] # arrays
        times = self._vehicles.dt, self._fall
        velocities = pulled(self._motion, sides, self._constants, self._tyres, times)
        self._world.set_velocities(self._bodies, *velocities)

    def observe(self) -> None:
        """Read the bodies' motion, after the engine's step."""
        self._before, self._motion = self._motion, self._world.motions(self._bodies)

    def row(self, number: int) -> tuple[Motion, Motion]:
        """Return the motion of one of them, and its motion one step ago."""
        one, before = (
            Motion(*(tuple(float(values[number]) for values in vector) for vector in motion))  # type: ignore[index, arg-type] # arrays
            for motion in (self._motion, self._before)
        )
        return one, before

    def state(self, time: int) -> RobotState:
        """Return the state that sensors measure, as arrays over all; ``time`` is simulated [ns]."""
        values = self._vehicles.take(self._indices)
        return measured(self._motion, self._before, values, (time, self._vehicles.dt))


def _stacked(motions: Sequence[Motion]) -> Motion:
    """Return the motions of many bodies as one motion of arrays."""
    return Motion(*(tuple(np.array(vectors).T) for vectors in zip(*motions, strict=True)))
