"""Interpreting commands: from JointState or Twist to the speeds of the two sides.

Pure decisions on one message, without its sender and time. Wrong ones are refused with the reason.
"""

import math
from collections.abc import Iterable, Sequence

from lcmtools.errors import ValueMismatch
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import JointState
from lcmtools_sim.drive import SideSpeeds, body_velocity, side_speeds
from lcmtools_sim.robots.model import RobotModel

_ROUNDING = 1 + 1e-6  # a controller that limits its own commands may compute in float32


def interpret(message: JointState | Twist, model: RobotModel) -> tuple[SideSpeeds, str]:
    """Return the side speeds [m/s] for a command, within the robot's limits.

    A Twist gives the forward speed and turn rate; a JointState gives the efforts of the sides
    (fractions of full power) or, without efforts, their wheel speeds [rad/s]. For another message,
    ValueMismatch names the field. With them comes a text: the first value beyond the robot's
    limits, to which it is reduced; "" for none.
    """
    drive = model.drive
    if isinstance(message, Twist):
        forward = _finite("linear.x", message.linear.x)
        turn_rate = _finite("angular.z", message.angular.z)
        names = "linear.x", "angular.z"
    elif not isinstance(message, JointState):
        what = f"a {type(message).__name__} is not a command"
        raise ValueMismatch(what, "send a JointState or a Twist")
    elif message.effort:
        left, right = _by_side("effort", message.effort, message.name, model)
        efforts = [(f"effort[{i}]", value, 1.0, "") for i, value in enumerate(message.effort)]
        full = drive.full_speed
        kept = (max(-1.0, min(1.0, side)) * full for side in (left, right))
        return SideSpeeds(*kept), _reduced(efforts)
    elif message.velocity:
        left, right = _by_side("velocity", message.velocity, message.name, model)
        speeds = (left * drive.wheel_radius, right * drive.wheel_radius)
        forward, turn_rate = body_velocity(*speeds, drive.track)
        names = "the speed of the wheels", "the turn rate of the wheels"
    else:
        raise ValueMismatch("neither effort nor velocity is given", "for example effort: [1, 1]")
    limits = (forward, drive.max_speed, " m/s"), (turn_rate, drive.max_turn_rate, " rad/s")
    values = [(name, *about) for name, about in zip(names, limits, strict=True)]
    return side_speeds(forward, turn_rate, drive), _reduced(values)


def _reduced(values: Iterable[tuple[str, float, float, str]]) -> str:
    """Return the first of some values, with its limit and unit, that is beyond the limit."""
    for name, value, limit, unit in values:
        if abs(value) > limit * _ROUNDING:
            return f"{name} is {value:.4g}{unit}, the limit {limit:g}{unit}"
    return ""


def _by_side(
    field: str, values: Sequence[float], names: Sequence[str], model: RobotModel
) -> tuple[float, float]:
    """Return the values of the left and right side, averaged over the wheels of each side."""
    names = names or (model.left_wheels[0], model.right_wheels[0])
    if len(values) != len(names):
        wanted = f"{len(names)} ({', '.join(names)})"
        raise ValueMismatch(f"{field} has the wrong length: {len(values)} instead of {wanted}")
    if len(set(names)) != len(names):
        raise ValueMismatch(f"a name is given twice in {list(names)}")
    known = (*model.left_wheels, *model.right_wheels)
    for name in names:
        if name not in known:
            raise ValueMismatch(f"unknown wheel '{name}'", f"known names: {', '.join(known)}")
    by_name = {n: _finite(f"{field}[{i}]", values[i]) for i, n in enumerate(names)}
    return _mean(by_name, model.left_wheels), _mean(by_name, model.right_wheels)


def _mean(by_name: dict[str, float], wheels: Sequence[str]) -> float:
    values = [by_name[wheel] for wheel in wheels if wheel in by_name]
    if not values:
        raise ValueMismatch(f"no value for the side of '{wheels[0]}'", "give both sides")
    return sum(values) / len(values)


def _finite(field: str, value: float) -> float:
    if not math.isfinite(value):
        raise ValueMismatch(f"{field} is {value}, which is not a finite number")
    return value
