"""Robots in the plane: their motors, encoders and tyres, and how they move on level ground.

One robot with floats, or many at once with arrays: every formula is the same. Neither the engine
nor the bodies that a robot may meet are known here: see fleet.py.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import astuple, dataclass
from typing import TypeVar, cast

import numpy as np
import numpy.typing as npt

from lcmtools.clock import split_stamp
from lcmtools_sim.arithmetic import FLOATS, Value, arithmetic_of
from lcmtools_sim.drive import body_velocity, dead_reckoning, followed
from lcmtools_sim.engines.engine import Motion
from lcmtools_sim.geometry import Vector, add, axes, components, cross, scaled, subtract
from lcmtools_sim.robots.model import RobotModel
from lcmtools_sim.sensors.sensor import RobotState, Sides
from lcmtools_sim.tyres import Tyres, gripping, skidding

Random = Callable[[int], Iterable[float]]


@dataclass(slots=True)
class Constants:
    """The constant values of a robot, or of many."""

    gain: Value  # of the motors in a step: see drive.followed
    largest_change: Value  # of the motors' speed in a step [m/s]
    largest_impulse: Value  # of the tyres of one side in a step, on level ground [N s]
    timeout: Value  # seconds after which a command ends; inf for never
    height: Value  # of the centre of mass above the ground [m]
    base: Value  # height of base_link above the centre of mass [m]
    mass: Value  # [kg]
    inertia: Value  # about the vertical [kg m^2]
    track: Value  # track and the following as in the model's drive
    wheel_radius: Value
    full_speed: Value


def constants_of(model: RobotModel, dt: float, timeout: float, friction: float) -> Constants:
    """A robot's constants; ``friction`` is gravity times the ground's coefficient [m/s^2]."""
    drive, body = model.drive, model.body
    return Constants(
        gain=dt / (drive.time_constant + dt),
        largest_change=drive.max_acceleration * dt,
        largest_impulse=friction * drive.tyre_friction * body.mass / 2 * dt,
        timeout=timeout - dt / 2,  # midway between two steps, because sums of steps are not exact
        height=body.centre_of_mass,
        base=body.base_height - body.centre_of_mass,
        mass=body.mass,
        inertia=body.inertia[2],
        track=drive.track,
        wheel_radius=drive.wheel_radius,
        full_speed=drive.full_speed,
    )


@dataclass(slots=True)
class Variables:
    """The state of a robot, or of many."""

    left_target: Value = 0.0  # the commanded speeds of the wheels [m/s]
    right_target: Value = 0.0
    command_age: Value = 0.0  # age of the command [s]
    left: Value = 0.0  # the speeds of the wheels [m/s]
    right: Value = 0.0
    left_angle: Value = 0.0  # of the wheels since the start [rad]
    right_angle: Value = 0.0
    odometry_x: Value = 0.0  # the pose by the encoders since the start [m, rad]
    odometry_y: Value = 0.0
    odometry_yaw: Value = 0.0
    x: Value = 0.0  # in the world [m, rad]
    y: Value = 0.0
    yaw: Value = 0.0
    vx: Value = 0.0  # in the world [m/s, rad/s]
    vy: Value = 0.0
    turn_rate: Value = 0.0
    before_vx: Value = 0.0  # the same one step ago
    before_vy: Value = 0.0
    before_turn_rate: Value = 0.0


RowT = TypeVar("RowT", Constants, Variables)


def _joined(rows: Sequence[RowT]) -> RowT:
    """Return many robots' values as arrays, in this order."""
    columns = [cast("float", np.array(column)) for column in zip(*map(astuple, rows), strict=True)]
    return type(rows[0])(*columns)


def _rows(values: RowT, indices: npt.NDArray[np.intp]) -> RowT:
    return type(values)(*(cast("float", column[indices]) for column in _columns(values)))


def _row(values: RowT, index: int) -> RowT:
    return type(values)(*(float(column[index]) for column in _columns(values)))


def _columns(values: Constants | Variables) -> list[npt.NDArray[np.float64]]:
    return [getattr(values, name) for name in values.__slots__]


class Vehicles:
    """One robot, or several with the same kind of tyres.

    Args:
        model: The model of the robot, or of one of them.
        constants: The constants of the robot, or of all.
        now: Their state at the start.
        dt: Duration of a step [s].
        noise: Standard deviation of the distance measured by one side's encoder after 1 m [m]; it
            grows like a random walk. Only for a single robot.
        random: Draws a number of samples of the standard normal distribution; needed for noise.
    """

    def __init__(
        self,
        model: RobotModel,
        constants: Constants,
        now: Variables,
        dt: float,
        noise: float = 0.0,
        random: Random = lambda _: (),
    ) -> None:
        self.model, self.constants, self.now = model, constants, now
        self.ops = arithmetic_of(constants.mass)
        self.is_single = self.ops is FLOATS
        self._can_expire = bool(np.any(np.isfinite(constants.timeout)))
        self.dt, self.noise, self._random = dt, noise / math.sqrt(dt), random
        self.tyres = self.tyres_of(constants)

    @classmethod
    def joined(cls, robots: "Sequence[tuple[Vehicles, int]]") -> "Vehicles":
        """Return the vehicles of robots, each given by its current vehicles and its index there."""
        constants, now = zip(*(vehicles.row(index) for vehicles, index in robots), strict=True)
        first = robots[0][0]
        if len(robots) == 1:
            return cls(first.model, constants[0], now[0], first.dt)
        return cls(first.model, _joined(constants), _joined(now), first.dt)

    def tyres_of(self, constants: Constants) -> Tyres:
        """Return the tyres of a robot, or of many, with these constants."""
        ops, drive = arithmetic_of(constants.mass), self.model.drive
        if drive.skids:
            return skidding(constants.mass, constants.inertia, drive.wheels, ops)
        return gripping(constants.mass, constants.inertia, constants.track, ops)

    def take(self, indices: npt.NDArray[np.intp]) -> tuple[Constants, Variables]:
        """Return some robots' values as arrays."""
        return _rows(self.constants, indices), _rows(self.now, indices)

    def row(self, index: int) -> tuple[Constants, Variables]:
        """Return one robot's values as floats."""
        if self.is_single:
            return self.constants, self.now
        return _row(self.constants, index), _row(self.now, index)

    def get(self, index: int, *names: str) -> list[float]:
        """Return variables of one robot."""
        found = [getattr(self.now, name) for name in names]
        return found if self.is_single else [float(column[index]) for column in found]

    def set(self, index: int, **values: float) -> None:
        """Set variables of one robot."""
        for name, value in values.items():
            if self.is_single:
                setattr(self.now, name, value)
            else:
                getattr(self.now, name)[index] = value

    def step(self) -> None:
        """Let the motors follow their targets, and the tyres pull the bodies, for one step."""
        now, k, ops, dt = self.now, self.constants, self.ops, self.dt
        if self._can_expire:
            goes_on = (now.command_age < k.timeout) * 1.0
            now.left_target = now.left_target * goes_on
            now.right_target = now.right_target * goes_on
            now.command_age = now.command_age + dt
        speeds, targets = (now.left, now.right), (now.left_target, now.right_target)
        left, right = now.left, now.right = followed(speeds, targets, k.gain, k.largest_change, ops)
        turn = dt / k.wheel_radius
        now.left_angle = now.left_angle + left * turn
        now.right_angle = now.right_angle + right * turn
        half_turn = (right - left) / k.track * (dt / 2)
        self._count(left, right, half_turn)
        heading = now.yaw + half_turn
        s, c = ops.sin(heading), ops.cos(heading)
        vx, vy, turn_rate = now.vx, now.vy, now.turn_rate
        now.before_vx, now.before_vy, now.before_turn_rate = vx, vy, turn_rate
        forward, aside, largest = vx * c + vy * s, vy * c - vx * s, k.largest_impulse
        along, across, twist = self.tyres(forward, aside, turn_rate, left, right, largest)
        now.vx, now.vy = vx, vy = vx + along * c - across * s, vy + along * s + across * c
        now.turn_rate = turn_rate = turn_rate + twist
        now.x, now.y, now.yaw = now.x + vx * dt, now.y + vy * dt, now.yaw + turn_rate * dt

    def _count(self, left: Value, right: Value, half_turn: Value) -> None:
        """Let the encoders count a step."""
        now, dt = self.now, self.dt
        if self.noise and (left or right):
            error, other_error = self._random(2)
            left = left + self.noise * abs(left) ** 0.5 * error
            right = right + self.noise * abs(right) ** 0.5 * other_error
            half_turn = (right - left) / self.constants.track * (dt / 2)
        pose = now.odometry_x, now.odometry_y, now.odometry_yaw
        pose = dead_reckoning(pose, (left + right) * (dt / 2), half_turn, self.ops)
        now.odometry_x, now.odometry_y, now.odometry_yaw = pose

    def state(self, time: int, index: int | None = None) -> RobotState:
        """Return the state that sensors measure on level ground, of one robot or as arrays of all.

        ``time`` is in simulated nanoseconds.
        """
        constants, now = (self.constants, self.now) if index is None else self.row(index)
        ops, half, per_step = arithmetic_of(now.yaw), now.yaw / 2, 1 / self.dt
        s, c = ops.sin(now.yaw), ops.cos(now.yaw)
        # The body moved along a chord, in the direction of its heading in the middle of the step.
        middle = now.yaw - now.turn_rate * (self.dt / 2)
        middle_s, middle_c = ops.sin(middle), ops.cos(middle)
        ax, ay = (now.vx - now.before_vx) * per_step, (now.vy - now.before_vy) * per_step
        return RobotState(
            time,
            split_stamp(time),
            (now.x, now.y, constants.height + constants.base),
            (0.0, 0.0, ops.sin(half), ops.cos(half)),
            (now.vx * middle_c + now.vy * middle_s, now.vy * middle_c - now.vx * middle_s, 0.0),
            (0.0, 0.0, now.turn_rate),
            (ax * c + ay * s, ay * c - ax * s, 0.0),
            (0.0, 0.0, (now.turn_rate - now.before_turn_rate) * per_step),
            *_of_wheels(constants, now),
        )


def planar_motions(constants: Constants, now: Variables) -> tuple[Motion, Motion]:
    """Return the motion of bodies on level ground, and the same with velocities of one step ago."""
    place, velocity = (now.x, now.y, constants.height), (now.vx, now.vy, 0.0)
    motion = planar_motion(place, now.yaw, velocity, now.turn_rate)
    before = (now.before_vx, now.before_vy, 0.0), (0.0, 0.0, now.before_turn_rate)
    return motion, Motion(*motion[:2], *before)


def planar_motion(position: Vector, yaw: Value, velocity: Vector, turn_rate: Value) -> Motion:
    """Return the motion of upright bodies."""
    ops, half = arithmetic_of(yaw), yaw / 2
    rotation = 0.0, 0.0, ops.sin(half), ops.cos(half)
    return Motion(position, rotation, velocity, (0.0, 0.0, turn_rate))


def measured(
    motion: Motion, before: Motion, values: tuple[Constants, Variables], times: tuple[int, float]
) -> RobotState:
    """Return the state that sensors measure.

    Args:
        motion: The body's motion.
        before: Its motion one step ago.
        values: The robot's values.
        times: Simulated time [ns], and duration of a step [s].
    """
    (constants, now), (time, dt) = values, times
    ops = arithmetic_of(now.yaw)
    frame = axes(motion.rotation)
    base_link = scaled(frame[2], constants.base)
    swing = cross(motion.angular_velocity, base_link)
    change = scaled(subtract(motion.velocity, before.velocity), 1 / dt)
    turning = subtract(motion.angular_velocity, before.angular_velocity)
    angular_acceleration = scaled(turning, 1 / dt)
    of_lever = add(cross(angular_acceleration, base_link), cross(motion.angular_velocity, swing))
    angular_velocity = components(motion.angular_velocity, frame)
    # The body moved along a chord, in the direction of its heading in the middle of the step.
    forward, left, up = components(add(motion.velocity, swing), frame)
    angle = angular_velocity[2] * dt / 2
    s, c = ops.sin(angle), ops.cos(angle)
    return RobotState(
        time,
        split_stamp(time),
        add(motion.position, base_link),
        motion.rotation,
        (forward * c - left * s, forward * s + left * c, up),
        angular_velocity,
        components(add(change, of_lever), frame),
        components(angular_acceleration, frame),
        *_of_wheels(constants, now),
    )


def _of_wheels(
    constants: Constants, now: Variables
) -> tuple[Sides, Sides, Sides, Vector, tuple[Value, Value]]:
    """Return the part of a state from motors and encoders, beginning with the wheels' angles."""
    ops = arithmetic_of(now.left)
    efforts = (
        ops.maximum(-1.0, ops.minimum(1.0, target / constants.full_speed))
        for target in (now.left_target, now.right_target)
    )
    return (
        Sides(now.left_angle, now.right_angle),
        Sides(now.left / constants.wheel_radius, now.right / constants.wheel_radius),
        Sides(*efforts),
        (now.odometry_x, now.odometry_y, now.odometry_yaw),
        body_velocity(now.left, now.right, constants.track),
    )
