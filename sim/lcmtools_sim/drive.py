"""Motors and encoders of a robot on wheels, as mathematical functions.

The tyres are in tyres.py. Symbols and signs are those of the textbook (R. Siegwart et al.,
Introduction to Autonomous Mobile Robots, section 3.2): v [m/s] forward, w [rad/s]
counter-clockwise, side speeds v -+ w track / 2. A Value may be an array, for many robots.
"""

from typing import NamedTuple

from lcmtools_sim.arithmetic import Arithmetic, Value
from lcmtools_sim.geometry import Vector
from lcmtools_sim.robots.model import Drive

_STANDSTILL = 1e-6  # [m/s]; a motor this close to its target has reached it
_TINY = 1e-300  # in place of 0 as a divisor


class SideSpeeds(NamedTuple):
    """Ground speeds of the left and the right wheels [m/s]."""

    left: float
    right: float


def side_speeds(forward: float, turn_rate: float, drive: Drive) -> SideSpeeds:
    """Return the side speeds for a forward speed [m/s] and turn rate [rad/s], within the limits.

    Above a limit both are reduced by the same factor, so that the robot stays on the same circle.
    """
    excess = max(1.0, abs(forward) / drive.max_speed, abs(turn_rate) / drive.max_turn_rate)
    half_difference = turn_rate / excess * (drive.believed_track or drive.track) / 2
    return SideSpeeds(forward / excess - half_difference, forward / excess + half_difference)


def body_velocity(left: Value, right: Value, track: Value) -> tuple[Value, Value]:
    """Return forward speed [m/s] and turn rate [rad/s] of a robot whose wheels do not slip."""
    return (left + right) / 2, (right - left) / track


def followed(
    speeds: tuple[Value, Value],
    targets: tuple[Value, Value],
    gain: Value,
    largest_change: Value,
    ops: Arithmetic,
) -> tuple[Value, Value]:
    """Return the motors' speeds one step later [m/s].

    First-order motors, implicit Euler (stable for any dt): the ``gain`` is dt / (dt + time
    constant). Both sides are limited together by the ``largest_change`` [m/s], so that the robot
    stays on its circle while it accelerates.
    """
    (left, right), (left_target, right_target) = speeds, targets
    left_lag, right_lag = left_target - left, right_target - right
    largest = ops.maximum(ops.absolute(left_lag), ops.absolute(right_lag))
    gain = ops.minimum(gain, largest_change / ops.maximum(largest, _TINY))
    gain = ops.maximum(gain, (largest < _STANDSTILL) * 1.0)
    return left + gain * left_lag, right + gain * right_lag


def dead_reckoning(pose: Vector, distance: Value, half_turn: Value, ops: Arithmetic) -> Vector:
    """Return the pose after a step.

    The robot moves along the chord of its arc, as the engine's bodies do.

    Args:
        pose: x, y [m] and yaw [rad] before.
        distance: The distance travelled in the step [m].
        half_turn: Half the angle turned in the step [rad].
        ops: The functions for these values.
    """
    x, y, yaw = pose
    heading = yaw + half_turn
    return (x + distance * ops.cos(heading), y + distance * ops.sin(heading), heading + half_turn)
