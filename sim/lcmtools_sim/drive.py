"""How a robot on wheels drives: motors and encoders, as plain mathematics.

Everything here is a function of numbers or a small state of numbers. What the wheels do to the
robot is tyres.py's. Symbols and signs are those of the textbook (R. Siegwart et al., Introduction
to Autonomous Mobile Robots, section 3.2): v [m/s] forward, w [rad/s] counter-clockwise, side
speeds v -+ w track / 2.
"""

import math
from collections.abc import Callable, Iterable
from typing import NamedTuple

from lcmtools_sim.robots.model import Drive

_STANDSTILL = 1e-6  # [m/s]; a motor this near to its target has reached it


class SideSpeeds(NamedTuple):
    """Ground speeds of the left and the right wheels [m/s]. A tuple, for it is made every step."""

    left: float
    right: float


STOPPED = SideSpeeds(0.0, 0.0)


def side_speeds(forward: float, turn_rate: float, drive: Drive) -> SideSpeeds:
    """The side speeds that make a robot drive so [m/s, rad/s], slowed to what it can.

    Where one of the two is above its limit both are reduced by the same factor, so that the robot
    keeps to the same circle.
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
    gain = dt / (drive.time_constant + dt)
    left, right = targets.left - speeds.left, targets.right - speeds.right
    largest = max(abs(left), abs(right))
    if largest < _STANDSTILL:
        return targets
    gain = min(gain, drive.max_acceleration * dt / largest)
    return SideSpeeds(speeds.left + gain * left, speeds.right + gain * right)


class Wheels:
    """The wheels of both sides: how fast they turn and how far they have turned.

    Attributes:
        speeds: Ground speeds [m/s].
        left_angle: Since the start [rad].
        right_angle: Since the start [rad].
    """

    __slots__ = ("left_angle", "right_angle", "speeds")

    def __init__(self) -> None:
        self.speeds = STOPPED
        self.left_angle = 0.0
        self.right_angle = 0.0

    def angles(self) -> tuple[float, float]:
        """How far the left and the right ones have turned since the start [rad]."""
        return self.left_angle, self.right_angle

    def turn(self, targets: SideSpeeds, drive: Drive, dt: float) -> None:
        """Turn for one step, the motors following ``targets``."""
        if self.speeds != targets:
            self.speeds = follow(self.speeds, targets, drive, dt)
        left, right = self.speeds
        gain = dt / drive.wheel_radius
        self.left_angle += left * gain
        self.right_angle += right * gain


class Encoders:
    """What the wheels' encoders count: each side's speed, with noise that grows like a random walk.

    Args:
        noise: Standard deviation of a side's way after 1 m [m]; 0 for exact ones.
        random: Draws that many numbers of the standard normal distribution.
    """

    __slots__ = ("_noise", "_random")

    def __init__(self, noise: float, random: Callable[[int], Iterable[float]]) -> None:
        self._noise = noise
        self._random = random

    def read(self, speeds: SideSpeeds, dt: float) -> SideSpeeds:
        """Each side's speed as it is counted over one step [m/s]."""
        if not self._noise:
            return speeds
        left, right = self._random(2)
        gain = self._noise / math.sqrt(dt)
        return SideSpeeds(
            speeds.left + gain * math.sqrt(abs(speeds.left)) * left,
            speeds.right + gain * math.sqrt(abs(speeds.right)) * right,
        )


class Odometer:
    """Where the robot would be if its wheels never slipped: dead reckoning from the encoders.

    Attributes:
        x: In the frame in which it started [m].
        y: [m]
        yaw: [rad], not wrapped.
    """

    __slots__ = ("x", "y", "yaw")

    def __init__(self) -> None:
        self.x = 0.0
        self.y = 0.0
        self.yaw = 0.0

    def advance(self, forward: float, turn_rate: float, dt: float) -> None:
        """Go on for one step [m/s, rad/s] along the chord of its arc."""
        heading = self.yaw + turn_rate * dt / 2
        self.x += forward * dt * math.cos(heading)
        self.y += forward * dt * math.sin(heading)
        self.yaw += turn_rate * dt
