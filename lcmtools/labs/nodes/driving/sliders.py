"""Two sliders for a robot's velocity, drawn as text, as plain values.

The keys are those of rqt's robot steering, and the arrows.
"""

from dataclasses import dataclass, replace

from lcmtools.labs.nodes.driving.keys import DOWN, LEFT, RIGHT, UP

SMALL_STEP, BIG_STEP = 0.01, 0.1
"""In m/s and rad/s."""
STEPS = {
    UP: (BIG_STEP, 0.0), DOWN: (-BIG_STEP, 0.0), LEFT: (0.0, BIG_STEP), RIGHT: (0.0, -BIG_STEP),
    "w": (SMALL_STEP, 0.0), "s": (-SMALL_STEP, 0.0),
    "a": (0.0, SMALL_STEP), "d": (0.0, -SMALL_STEP),
    "W": (BIG_STEP, 0.0), "S": (-BIG_STEP, 0.0), "A": (0.0, BIG_STEP), "D": (0.0, -BIG_STEP),
}  # fmt: skip
"""By key: what it adds to the forward speed [m/s] and to the turn rate [rad/s]."""

KEY_HELP = """\
up / down      forward speed 0.1 m/s more / less    (w / s: 0.01, W / S: 0.1)
left / right   turn rate 0.1 rad/s to that side     (a / d: 0.01, A / D: 0.1)
x              go straight ahead at 0 m/s           (forward speed 0)
z              turn no more                         (turn rate 0)
space          stop; any other key does so too
Ctrl-C         stop and end"""

_WIDTH = 21
_DIGITS = 2  # of the smallest step: sums of steps are kept exact


@dataclass(frozen=True, slots=True)
class Sliders:
    """The positions of the two sliders.

    Attributes:
        forward: Forward speed [m/s].
        turn_rate: Turn rate [rad/s], positive to the left.
        most_forward: Largest forward speed, and backward too [m/s].
        most_turn_rate: Largest turn rate to either side [rad/s].
    """

    forward: float = 0.0
    turn_rate: float = 0.0
    most_forward: float = 1.0
    most_turn_rate: float = 3.0

    def after(self, key: str) -> "Sliders":
        """Return the sliders once a key is pressed."""
        if key in STEPS:
            faster, more_left = STEPS[key]
            return replace(
                self,
                forward=_within(self.forward + faster, self.most_forward),
                turn_rate=_within(self.turn_rate + more_left, self.most_turn_rate),
            )
        if key in ("x", "X"):
            return replace(self, forward=0.0)
        if key in ("z", "Z"):
            return replace(self, turn_rate=0.0)
        return self.stopped()

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
    cells = list("-" * _WIDTH)
    cells[_WIDTH // 2] = "|"
    cells[round((position + 1) / 2 * (_WIDTH - 1))] = "O"
    return f"[{''.join(cells)}]"
