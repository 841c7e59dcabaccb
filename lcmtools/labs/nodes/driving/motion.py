"""The velocities that keys set, as plain values: for teleoperation and for two sliders."""

from dataclasses import dataclass, replace

from lcmtools.terminal import DOWN, LEFT, RIGHT, UP

DIRECTIONS = {
    "u": (1, 1), "i": (1, 0), "o": (1, -1),
    "j": (0, 1), "k": (0, 0), "l": (0, -1),
    "m": (-1, -1), ",": (-1, 0), ".": (-1, 1),
    UP: (1, 0), LEFT: (0, 1), RIGHT: (0, -1), DOWN: (-1, 0),
}  # fmt: skip
"""By key: forward (1) or backward (-1), and left (1) or right (-1)."""
SPEED_CHANGES = {
    "q": (1.1, 1.1), "w": (1.1, 1.0), "e": (1.0, 1.1),
    "z": (0.9, 0.9), "x": (0.9, 1.0), "c": (1.0, 0.9),
}  # fmt: skip
"""By key: factors of the speed and of the turn rate."""
MOTION_HELP = """\
u i o    forward left, forward, forward right     q / z   both speeds 10 % more / less
j k l    turn left, stop, turn right              w / x   forward speed 10 % more / less
m , .    backward: clockwise, straight,           e / c   turn rate 10 % more / less
         counter-clockwise
The arrows drive too; any other key stops. Capitals mean the same. Ctrl-C stops and ends."""

_STEPS = {
    UP: (0.1, 0.0), DOWN: (-0.1, 0.0), LEFT: (0.0, 0.1), RIGHT: (0.0, -0.1),
    "w": (0.01, 0.0), "s": (-0.01, 0.0), "a": (0.0, 0.01), "d": (0.0, -0.01),
    "W": (0.1, 0.0), "S": (-0.1, 0.0), "A": (0.0, 0.1), "D": (0.0, -0.1),
}  # fmt: skip
"""By key of the sliders: changes of the forward speed [m/s] and of the turn rate [rad/s]."""
_DIGITS = 2  # of the smallest step: sums of steps are kept exact
_WIDTH = 21  # of a slider [characters]
SLIDERS_HELP = """\
up / down      forward speed 0.1 m/s more / less    (w / s: 0.01, W / S: 0.1)
left / right   turn rate 0.1 rad/s to that side     (a / d: 0.01, A / D: 0.1)
x              go straight ahead at 0 m/s           (forward speed 0)
z              stop turning                         (turn rate 0)
space          stop; any other key does so too
Ctrl-C         stop and end"""


@dataclass(frozen=True, slots=True)
class Motion:
    """The current motion of a robot, driven like teleop_twist_keyboard does.

    A key sets the direction, or changes a speed. Capitals mean the same.
    """

    speed: float = 0.5  # forward speed that is set [m/s]
    turn: float = 1.0  # turn rate that is set [rad/s]
    speed_limit: float = 1000.0  # largest speed [m/s]
    turn_limit: float = 1000.0  # largest turn rate [rad/s]
    direction: int = 0  # forward (1), backward (-1) or neither
    rotation: int = 0  # left (1), right (-1) or neither

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
    """A key that is held down, inferred from its repetitions: terminals report no release.

    A held key is repeated after a quarter to two thirds of a second, then many times a second.
    """

    FIRST_TIME, NEXT_TIME = 0.7, 0.2
    """Times that a key counts as held after it came first, and again [s]."""

    def __init__(self) -> None:
        self._key = ""
        self._until = 0

    def press(self, key: str, now: int) -> None:
        """Handle a key that came at ``now`` [ns]."""
        is_repeated = key == self._key and now < self._until
        self._until = now + round((self.NEXT_TIME if is_repeated else self.FIRST_TIME) * 1e9)
        self._key = key

    def is_over(self, now: int) -> bool:
        """Return True if it must have been released before ``now`` [ns]."""
        return now >= self._until


@dataclass(frozen=True, slots=True)
class Sliders:
    """The positions of two sliders with the keys of rqt's robot steering, and the arrows."""

    forward: float = 0.0  # forward speed [m/s]
    turn_rate: float = 0.0  # turn rate [rad/s], positive to the left
    most_forward: float = 1.0  # largest forward speed, and backward too [m/s]
    most_turn_rate: float = 3.0  # largest turn rate to either side [rad/s]

    def after(self, key: str) -> "Sliders":
        """Return the sliders once a key is pressed."""
        if key in ("x", "X"):
            return replace(self, forward=0.0)
        if key in ("z", "Z"):
            return replace(self, turn_rate=0.0)
        if key not in _STEPS:
            return self.stopped()
        faster, more_left = _STEPS[key]
        return replace(
            self,
            forward=_within(self.forward + faster, self.most_forward),
            turn_rate=_within(self.turn_rate + more_left, self.most_turn_rate),
        )

    def stopped(self) -> "Sliders":
        """Return both in the middle."""
        return replace(self, forward=0.0, turn_rate=0.0)

    def __str__(self) -> str:
        """Return one line; the slider of the turn rate shows left at the left."""
        forward = _slider(self.forward / self.most_forward)
        turn = _slider(-self.turn_rate / self.most_turn_rate)
        return (
            f"back {forward} forward {self.forward:+.2f} m/s"
            f"   left {turn} right {self.turn_rate:+.2f} rad/s"
        )


def _within(value: float, most: float) -> float:
    return round(max(-most, min(most, value)), _DIGITS) + 0.0  # no -0.0


def _slider(position: float) -> str:
    """Draw a slider at a position from -1 to 1."""
    cells = list("-" * _WIDTH)
    cells[_WIDTH // 2] = "|"
    cells[round((position + 1) / 2 * (_WIDTH - 1))] = "O"
    return f"[{''.join(cells)}]"
