"""The control law of simple_controller: from velocities to wheel efforts, as plain mathematics.

It imports no node, message or clock: velocities and the time are inputs, efforts are outputs.
"""

import math
from dataclasses import dataclass

TRACK = 1.0702
"""Effective track of the Husky [m]: 1.875 times the distance of its wheels, for they skid in turns
(``wheel_separation_multiplier`` of Clearpath's husky_control)."""
MAX_SPEED = 1.0  # speed of a side at full effort [m/s]
MAX_STEP = 0.1
"""Longest time that one observation counts for [s]: the motion during a gap is unknown."""
REST_SPEED = 0.01  # a robot whose sides are both slower than this is at rest [m/s]


@dataclass(frozen=True, slots=True)
class Velocity:
    """The motion of the robot's body."""

    forward: float  # along its x axis [m/s]
    turn_rate: float  # about its z axis, positive to the left [rad/s]

    def __str__(self) -> str:
        """As a log line shows it."""
        return f"linear.x {self.forward} m/s, angular.z {self.turn_rate} rad/s"

    def is_finite(self) -> bool:
        """Return True if both numbers are finite."""
        return math.isfinite(self.forward) and math.isfinite(self.turn_rate)

    def side_speeds(self) -> tuple[float, float]:
        """Return the speeds of the left and right wheels over the ground [m/s]."""
        half_difference = self.turn_rate * TRACK / 2
        return self.forward - half_difference, self.forward + half_difference

    def within_reach(self) -> "Velocity":
        """Return the same curve at a speed that both sides can reach."""
        fastest_side = abs(self.forward) + abs(self.turn_rate) * TRACK / 2
        excess = max(1.0, fastest_side / MAX_SPEED)
        return Velocity(self.forward / excess, self.turn_rate / excess)


@dataclass(frozen=True, slots=True)
class Gains:
    """Gains of a proportional-integral controller.

    A side of the Husky follows its effort as a first-order lag of 0.15 s. With ki / kp = 1 / 0.15 s
    the controller's zero cancels the lag's pole, and the closed loop is a first-order lag of
    0.15 s / kp: no steady error, no overshoot (S. Skogestad, Simple analytic rules for model
    reduction and PID controller tuning, Journal of Process Control 13, 2003, without delay).
    """

    kp: float = 1.0  # effort per speed error [s/m]
    ki: float = 6.7  # effort per speed error and second [1/m]


class SideControl:
    """A proportional-integral controller of the speed of one side."""

    def __init__(self) -> None:
        self._integral = 0.0

    def effort(self, error: float, step: float, gains: Gains) -> float:
        """Return the effort to apply now, in [-1, 1], at an error of desired minus measured [m/s].

        ``step`` is the time since the last call [s].
        """
        integral = self._integral + gains.ki * error * step
        wanted = gains.kp * error + integral
        possible = max(-1.0, min(1.0, wanted))
        # anti-windup: at the limit the integral may only lead away from it
        if wanted == possible or error * wanted < 0:
            self._integral = integral
        return possible


class VelocityControl:
    """Controls the velocity of a robot with skid steering by the efforts of its two sides."""

    def __init__(self, gains: Gains) -> None:
        # Gains of both sides. They may change: no effort jumps where the error is 0.
        self.gains = gains
        self._sides = SideControl(), SideControl()
        self._last_time: int | None = None

    def efforts(self, desired: Velocity, measured: Velocity, time: int) -> tuple[float, float]:
        """Return the efforts of the left and right wheels, each in [-1, 1].

        ``measured`` is the velocity by odometry, at ``time`` [ns].
        """
        step = self._step(time)
        speeds = measured.side_speeds()
        wanted = desired.within_reach().side_speeds()
        if not any(wanted) and all(abs(speed) < REST_SPEED for speed in speeds):
            self._sides = SideControl(), SideControl()  # no effort is left over to creep with
            return 0.0, 0.0
        left, right = (
            side.effort(goal - speed, step, self.gains)
            for side, goal, speed in zip(self._sides, wanted, speeds, strict=True)
        )
        return left, right

    def _step(self, time: int) -> float:
        """Return the time since the last call [s], at most MAX_STEP; forget all if negative."""
        step = 0.0 if self._last_time is None else (time - self._last_time) / 1e9
        self._last_time = time
        if step < 0:
            self._sides = SideControl(), SideControl()
        return max(0.0, min(step, MAX_STEP))
