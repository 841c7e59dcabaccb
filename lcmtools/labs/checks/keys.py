"""The Pioneer lab's table of keys, and what a robot should be told after each. Pure.

The meaning of each key is that of teleop_twist_keyboard, which the lab's table agrees with:
forward is positive, and so is a turn to the left.
"""

import math
from dataclasses import dataclass

TOLERANCE = 0.01
"""Part of the wanted value that may be missing."""

DIRECTIONS = {
    "i": (1, 0, "forward"),
    ",": (-1, 0, "backward"),
    "j": (0, 1, "left on the spot"),
    "l": (0, -1, "right on the spot"),
    "u": (1, 1, "forward to the left"),
    "o": (1, -1, "forward to the right"),
    "m": (-1, -1, "backward, clockwise"),
    ".": (-1, 1, "backward, counter-clockwise"),
}
"""Per key: factor of the forward speed, of the turn rate, and in words."""

FACTORS = {
    "q": (1.1, 1.1, "both 10 % more"),
    "z": (0.9, 0.9, "both 10 % less"),
    "w": (1.1, 1.0, "speed 10 % more"),
    "x": (0.9, 1.0, "speed 10 % less"),
    "e": (1.0, 1.1, "turning 10 % more"),
    "c": (1.0, 0.9, "turning 10 % less"),
}
"""Per key: factor of the forward speed, of the turn rate, and in words."""

STOP = "k"


@dataclass(frozen=True, slots=True)
class Command:
    """A command to a robot.

    Attributes:
        forward: [m/s]
        turn_rate: [rad/s], positive to the left.
    """

    forward: float
    turn_rate: float

    def is_like(self, other: "Command") -> bool:
        """Return whether both mean the same, but for rounding."""
        pairs = ((self.forward, other.forward), (self.turn_rate, other.turn_rate))
        return all(math.isclose(a, b, rel_tol=TOLERANCE, abs_tol=1e-6) for a, b in pairs)

    def __str__(self) -> str:
        """Both numbers with their units."""
        return f"{self.forward:+.3f} m/s, {self.turn_rate:+.3f} rad/s"


def after(key: str, speeds: Command) -> Command:
    """The command of a direction's key.

    Args:
        key: One of DIRECTIONS, or STOP.
        speeds: The forward speed and turn rate that are set.
    """
    along, around, _ = DIRECTIONS.get(key, (0, 0, ""))
    return Command(along * speeds.forward, around * speeds.turn_rate)


def changed(key: str, speeds: Command) -> Command:
    """The speeds after a key of FACTORS."""
    more_forward, more_turn, _ = FACTORS[key]
    return Command(speeds.forward * more_forward, speeds.turn_rate * more_turn)
