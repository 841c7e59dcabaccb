"""Motors and encoders of a robot on wheels, as plain mathematics.

The tyres are in tyres.py. Symbols and signs are those of the textbook (R. Siegwart et al.,
Introduction to Autonomous Mobile Robots, section 3.2): v [m/s] forward, w [rad/s]
counter-clockwise, side speeds v -+ w track / 2.
"""

from collections.abc import Callable, Iterable
from math import cos, sin, sqrt
from typing import NamedTuple

from lcmtools_sim.geometry import Vector
from lcmtools_sim.robots.model import Drive

Random = Callable[[int], Iterable[float]]

_STANDSTILL = 1e-6  # [m/s]; a motor this near to its target has reached it


class SideSpeeds(NamedTuple):
    """Ground speeds of the left and the right wheels [m/s]. A tuple, for it is made every step."""

    left: float
    right: float


STOPPED = SideSpeeds(0.0, 0.0)


def side_speeds(forward: float, turn_rate: float, drive: Drive) -> SideSpeeds:
    """The side speeds for this forward speed and turn rate [m/s, rad/s], within the limits.

    Above a limit both are reduced by the same factor, so that the robot keeps to the same circle.
    """
    excess = max(1.0, abs(forward) / drive.max_speed, abs(turn_rate) / drive.max_turn_rate)
    half_difference = turn_rate / excess * (drive.believed_track or drive.track) / 2
    return SideSpeeds(forward / excess - half_difference, forward / excess + half_difference)


def body_velocity(speeds: SideSpeeds, track: float) -> tuple[float, float]:
    """Forward speed [m/s] and turn rate [rad/s] of a robot whose wheels do not slip."""
    return (speeds.left + speeds.right) / 2, (speeds.right - speeds.left) / track


def follow(speeds: SideSpeeds, targets: SideSpeeds, drive: Drive, dt: float) -> SideSpeeds:
    """The motors' speeds one step later.

    First-order motors, implicit Euler (stable for any dt). Both sides are slowed together at the
    acceleration limit, so that the robot keeps its circle while it speeds up.
    """
    (left, right), (left_target, right_target) = speeds, targets
    left_lag, right_lag = left_target - left, right_target - right
    largest = max(abs(left_lag), abs(right_lag))
    if largest < _STANDSTILL:
        return targets
    gain = min(dt / (drive.time_constant + dt), drive.max_acceleration * dt / largest)
    return SideSpeeds(left + gain * left_lag, right + gain * right_lag)


def dead_reckoning(pose: Vector, distance: float, half_turn: float, steps: int = 1) -> Vector:
    """The pose after a number of steps of the same motion.

    In each step the robot moves along the chord of its arc, as the engine's bodies do; the sum of
    the chords has a closed form.

    Args:
        pose: x, y [m] and yaw [rad] before.
        distance: Of a step [m].
        half_turn: Half the angle of a step [rad].
        steps: Their number.
    """
    x, y, yaw = pose
    heading = yaw + steps * half_turn
    if steps > 1 and half_turn:
        distance *= sin(steps * half_turn) / sin(half_turn)
    else:
        distance *= steps
    return x + distance * cos(heading), y + distance * sin(heading), heading + steps * half_turn


class Drivetrain:
    """Both sides' motors and wheels, and their encoders, whose noise grows like a random walk.

    While the speeds stay the same only steps are counted: angles and pose are computed when they
    are read, which changes nothing.

    Args:
        drive: The motors.
        dt: Seconds of a step.
        noise: Standard deviation of a side's distance by its encoder after 1 m [m].
        random: Draws that many numbers of the standard normal distribution; needed for noise.

    Attributes:
        speeds: Ground speeds of the wheels [m/s].
        mid_turn: Sine and cosine of half the angle by which wheels that do not slip turn the robot
            in half a step: the quaternion's z and w.
    """

    def __init__(
        self, drive: Drive, dt: float, noise: float = 0.0, random: Random = lambda _: ()
    ) -> None:
        self._drive = drive
        self._dt = dt
        self._angle_by_speed = dt / drive.wheel_radius  # [rad s/m] in a step
        self._half_turn_by_speed = dt / drive.track / 2  # [rad s/m]
        self._noise = noise / sqrt(dt)
        self._random = random
        self._angles = 0.0, 0.0
        self._pose = 0.0, 0.0, 0.0
        self._steps = 0
        self._change(STOPPED)

    def step(self, targets: SideSpeeds) -> None:
        """Let the motors follow ``targets`` for one step [m/s]."""
        if self.speeds != targets:
            self._change(follow(self.speeds, targets, self._drive, self._dt))
        elif self._noise and targets != STOPPED:
            self._change(targets)  # the encoders read another speed in each step
        self._steps += 1

    def stop(self) -> None:
        """Stop at once."""
        self._change(STOPPED)

    def angles(self) -> tuple[float, float]:
        """The angles of the left and the right wheels since the start [rad]."""
        (left, right), (left_speed, right_speed) = self._angles, self.speeds
        gain = self._steps * self._angle_by_speed
        return left + gain * left_speed, right + gain * right_speed

    def odometry_pose(self) -> Vector:
        """x, y [m] and yaw [rad, not wrapped] by the encoders, relative to the start."""
        return dead_reckoning(self._pose, self._distance, self._half_turn, self._steps)

    def _change(self, speeds: SideSpeeds) -> None:
        """Continue with other speeds."""
        if self._steps:
            self._angles, self._pose = self.angles(), self.odometry_pose()
            self._steps = 0
        self.speeds = speeds
        left, right = speeds
        quarter_turn = (right - left) * self._half_turn_by_speed / 2
        self.mid_turn = sin(quarter_turn), cos(quarter_turn)
        if self._noise:
            error, other_error = self._random(2)
            left += self._noise * sqrt(abs(left)) * error
            right += self._noise * sqrt(abs(right)) * other_error
        self._distance = (left + right) / 2 * self._dt
        self._half_turn = (right - left) * self._half_turn_by_speed
