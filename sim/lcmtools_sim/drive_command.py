"""Interpreting commands: from JointState or Twist to the speeds of the two sides.

Pure decisions on one message, without its sender and time. Wrong ones are refused with the reason.
"""

import math
from collections.abc import Sequence

from lcmtools.errors import ValueMismatch
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import JointState
from lcmtools_sim.drive import SideSpeeds, body_velocity, side_speeds
from lcmtools_sim.robots.model import RobotModel

_ROUNDING = 1 + 1e-6  # a controller that limits its own commands may compute in float32


def interpret(message: JointState | Twist, model: RobotModel) -> SideSpeeds:
    """Return the side speeds [m/s] for a command, within the robot's limits.

    A Twist gives the forward speed and turn rate; a JointState gives the efforts of the sides
    (fractions of full power) or, without efforts, their wheel speeds [rad/s]. For another message,
    ValueMismatch names the field.
    """
    if isinstance(message, Twist):
        forward = _finite("linear.x", message.linear.x)
        return side_speeds(forward, _finite("angular.z", message.angular.z), model.drive)
    if not isinstance(message, JointState):
        what = f"a {type(message).__name__} is not a command"
        raise ValueMismatch(what, "send a JointState or a Twist")
    if message.effort:
        left, right = _by_side("effort", message.effort, message.name, model)
        full = model.drive.full_speed
        return SideSpeeds(max(-1.0, min(1.0, left)) * full, max(-1.0, min(1.0, right)) * full)
    if message.velocity:
        speeds = _wheel_speeds(message, model)
        return side_speeds(*body_velocity(*speeds, model.drive.track), model.drive)
    raise ValueMismatch("neither effort nor velocity is given", "for example effort: [1, 1]")


def out_of_range(message: JointState | Twist, model: RobotModel) -> str:
    """Return the first value beyond the robot's limits, to which it is reduced; "" for none.

    ``interpret`` must accept the message.
    """
    drive = model.drive
    if isinstance(message, JointState) and message.effort:
        values = [(f"effort[{i}]", value, 1.0, "") for i, value in enumerate(message.effort)]
    else:
        names, (forward, turn_rate) = ("linear.x", "angular.z"), (0.0, 0.0)
        if isinstance(message, Twist):
            forward, turn_rate = message.linear.x, message.angular.z
        else:
            names = "the speed of the wheels", "the turn rate of the wheels"
            forward, turn_rate = body_velocity(*_wheel_speeds(message, model), drive.track)
        values = [
            (names[0], forward, drive.max_speed, " m/s"),
            (names[1], turn_rate, drive.max_turn_rate, " rad/s"),
        ]
    for name, value, limit, unit in values:
        if abs(value) > limit * _ROUNDING:
            return f"{name} is {value:.4g}{unit}, the limit {limit:g}{unit}"
    return ""


def _wheel_speeds(state: JointState, model: RobotModel) -> SideSpeeds:
    left, right = _by_side("velocity", state.velocity, state.name, model)
    return SideSpeeds(left * model.drive.wheel_radius, right * model.drive.wheel_radius)


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
