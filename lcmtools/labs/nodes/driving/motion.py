"""The meaning of a teleoperated robot's keys, as plain values.

The table is that of teleop_twist_keyboard for robots that cannot move sideways, and of the Pioneer
lab: a key sets the direction of driving, or changes how fast. Capitals mean the same.
"""

from dataclasses import dataclass, replace

from lcmtools.labs.nodes.driving.keys import DOWN, LEFT, RIGHT, UP

FASTER, SLOWER = 1.1, 0.9

DIRECTIONS = {
    "u": (1, 1), "i": (1, 0), "o": (1, -1),
    "j": (0, 1), "k": (0, 0), "l": (0, -1),
    "m": (-1, -1), ",": (-1, 0), ".": (-1, 1),
    UP: (1, 0), LEFT: (0, 1), RIGHT: (0, -1), DOWN: (-1, 0),
}  # fmt: skip
"""By key: forward (1) or backward (-1), and left (1) or right (-1)."""
SPEED_CHANGES = {
    "q": (FASTER, FASTER), "w": (FASTER, 1.0), "e": (1.0, FASTER),
    "z": (SLOWER, SLOWER), "x": (SLOWER, 1.0), "c": (1.0, SLOWER),
}  # fmt: skip
"""By key: factors of the speed and of the turn rate."""

KEY_HELP = """\
drive:   u i o      forward to the left, forward, forward to the right
         j k l      turn left, stop, turn right
         m , .      backward: clockwise, straight, counter-clockwise
speed:   q / z      both 10 % more / less
         w / x      forward speed only
         e / c      turn rate only
arrows drive too; any other key stops; Ctrl-C stops and ends"""


@dataclass(frozen=True, slots=True)
class Motion:
    """The present motion of a driven robot.

    Attributes:
        speed: Forward speed that the keys command [m/s].
        turn: Turn rate that the keys command [rad/s].
        speed_limit: Largest speed [m/s].
        turn_limit: Largest turn rate [rad/s].
        direction: Forward (1), backward (-1) or neither.
        rotation: Left (1), right (-1) or neither.
    """

    speed: float = 0.5
    turn: float = 1.0
    speed_limit: float = 1000.0
    turn_limit: float = 1000.0
    direction: int = 0
    rotation: int = 0

    def after(self, key: str) -> "Motion":
        """Return the motion once a key is pressed; a key without a meaning stops the robot."""
        key = key if len(key) > 1 else key.lower()
        if key in SPEED_CHANGES:
            speed_factor, turn_factor = SPEED_CHANGES[key]
            return self.with_speeds(self.speed * speed_factor, self.turn * turn_factor)
        direction, rotation = DIRECTIONS.get(key, (0, 0))
        return replace(self, direction=direction, rotation=rotation)

    def with_speeds(self, speed: float, turn: float) -> "Motion":
        """Return the same with other speeds, within the limits."""
        return replace(self, speed=min(speed, self.speed_limit), turn=min(turn, self.turn_limit))

    def stopped(self) -> "Motion":
        """Return the same at rest."""
        return replace(self, direction=0, rotation=0)

    @property
    def forward(self) -> float:
        """Commanded forward speed [m/s]."""
        return self.direction * self.speed

    @property
    def turn_rate(self) -> float:
        """Commanded turn rate [rad/s], positive to the left."""
        return self.rotation * self.turn

    def __str__(self) -> str:
        """Return one line: the command, the speeds that are set, and the limits."""
        return (
            f"v {self.forward:+.2f} m/s  \N{GREEK SMALL LETTER OMEGA} {self.turn_rate:+.2f} rad/s"
            f"   speed {_with_limit(self.speed, self.speed_limit)}"
            f"  turn {_with_limit(self.turn, self.turn_limit)}"
        )


def _with_limit(value: float, limit: float) -> str:
    return f"{value:.2f} (limit{' reached' if value >= limit else ''} {limit:g})"


class HeldKey:
    """A key that is held down, as far as a terminal reports it.

    No terminal reports a release. A held key comes again: the second time after a quarter
    to two thirds of a second, as the system is configured, then many times a second.
    """

    FIRST_TIME, NEXT_TIME = 0.7, 0.2
    """Times that a key counts as held after it came first, and again [s]."""

    def __init__(self) -> None:
        self._key = ""
        self._until = 0

    def press(self, key: str, now: int) -> None:
        """Take a key that came at ``now`` [ns]."""
        is_repeated = key == self._key and now < self._until
        self._until = now + round((self.NEXT_TIME if is_repeated else self.FIRST_TIME) * 1e9)
        self._key = key

    def is_over(self, now: int) -> bool:
        """Return whether it must have been released before ``now`` [ns]."""
        return now >= self._until
