"""The keys that drive: their meanings, and the causes of wrong commands. Pure."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TypeVar

from lcmtools.labs.checks.diagnosis import misplaced, velocity_of
from lcmtools.labs.checks.measures import velocity_text
from lcmtools.labs.checks.results import Cause, CheckResult
from lcmtools.labs.nodes.driving.motion import DIRECTIONS, SPEED_CHANGES
from lcmtools.types.geometry_msgs import Twist

_TOLERANCE = 0.01
_FASTEST_TURN = 10.0  # [rad/s]; a Pioneer turns at 5.2 rad/s at most

_DRIVING_MEANINGS = {
    (1, 0): "forward",
    (-1, 0): "backward",
    (0, 1): "left on the spot",
    (0, -1): "right on the spot",
    (1, 1): "forward to the left",
    (1, -1): "forward to the right",
    (-1, -1): "backward, clockwise",
    (-1, 1): "backward, counter-clockwise",
    (0, 0): "stop",
}
_SPEED_MEANINGS = {
    (1.1, 1.1): "both 10 % more",
    (0.9, 0.9): "both 10 % less",
    (1.1, 1.0): "speed 10 % more",
    (0.9, 1.0): "speed 10 % less",
    (1.0, 1.1): "turning 10 % more",
    (1.0, 0.9): "turning 10 % less",
}
_MotionT = TypeVar("_MotionT", tuple[int, int], tuple[float, float])


def _meanings(keys: Mapping[str, _MotionT], words: Mapping[_MotionT, str]) -> dict[str, str]:
    """Return the meaning of each letter and sign, in the order of the meanings."""
    letters = {motion: key for key, motion in keys.items() if len(key) == 1}
    return {letters[motion]: meaning for motion, meaning in words.items()}


DRIVING_KEYS = _meanings(DIRECTIONS, _DRIVING_MEANINGS)
"""Meanings of the keys that drive, which are those of teleop_twist_keyboard."""
SPEED_KEYS = _meanings(SPEED_CHANGES, _SPEED_MEANINGS)
"""Meanings of the keys that change a speed."""

Velocity = tuple[float, float]  # forward speed [m/s] and turn rate [rad/s], positive to the left


def is_alike(velocity: Velocity | None, wanted: Velocity) -> bool:
    """Return True if both are equal except for rounding."""
    return velocity is not None and all(
        math.isclose(value, target, rel_tol=_TOLERANCE, abs_tol=1e-6)
        for value, target in zip(velocity, wanted, strict=True)
    )


@dataclass(frozen=True, slots=True)
class KeyPress:
    """A pressed key, the expected command, and the command that came, if any."""

    key: str
    wanted: Velocity
    twist: Twist | None
    changes: bool = True  # False if the commands go on as before, whatever these were
    as_capital: bool = False  # True if the capital letter does what is wanted


def key_cause(press: KeyPress, drives: Mapping[str, KeyPress]) -> Cause:
    """Return the cause of a key's wrong command, from the commands of all driving keys."""
    key, wanted, got = press.key, press.wanted, velocity_of(press.twist)
    if press.as_capital:
        text = f"'{key.upper()}' does it, and '{key}' does not: the keys are lower-case letters"
        return Cause("capitals", f"{text}, though older texts print some as capitals")
    if press.twist is None or got is None:
        text = f"nothing is published for '{key}': is each key read at once, and is it known?"
        return Cause("unanswered", text)
    if odd := misplaced(press.twist):
        return odd
    for index, name in enumerate(("speed", "turn")):
        if _is_reversed(drives, index) and is_alike(got, _reversed(wanted, index)):
            side = ("forward is linear.x above 0", "left is angular.z above 0")[index]
            return Cause(f"{name}-sign", f"wrong sign of {name}: {side}")
    other = next((k for k, drive in drives.items() if k != key and is_alike(got, drive.wanted)), "")
    text = f"compare '{key}' with the table of keys in the lab"
    if not (any(got) and press.changes):
        does = "changes nothing" if any(got) else "stops the robot"
        text = f"'{key}' {does}: is it in the program's table of keys, in lower case?"
    elif other:
        pair = "".join(sorted((key, other)))
        text = f"'{key}' does what '{other}' should do ({DRIVING_KEYS[other]})"
        return Cause(f"key-{pair}", f"{text}: the keys are mixed up")
    return Cause(f"key-{key}", text)


def _is_reversed(drives: Mapping[str, KeyPress], index: int) -> bool:
    """Return True if most keys command the opposite speed or turn rate."""
    moving = [drive for drive in drives.values() if drive.wanted[index]]
    wrong = [
        drive
        for drive in moving
        if drive.twist and (velocity_of(drive.twist) or (0, 0))[index] * drive.wanted[index] < 0
    ]
    return len(wrong) > len(moving) / 2


def _reversed(velocity: Velocity, index: int) -> Velocity:
    return (-velocity[0], velocity[1]) if index == 0 else (velocity[0], -velocity[1])


def speeds_result(drives: Mapping[str, KeyPress]) -> CheckResult:
    """Return the row for the directions of the two basic keys."""
    i, j = (velocity_of(drives[key].twist) or (0.0, 0.0) for key in "ij")
    speeds = i[0], j[1]
    cause = key_cause(drives["i" if speeds[0] <= 0 else "j"], drives)
    is_ok = min(speeds) > 0 and speeds[1] < _FASTEST_TURN
    if speeds[1] >= _FASTEST_TURN:
        cause = Cause("unit", "angular.z is in rad/s, not in degrees")
    what, wanted = "speeds of i and j", f"above 0, below {_FASTEST_TURN:g} rad/s"
    return CheckResult(what, wanted, velocity_text(speeds), is_ok, cause.text, cause.key)


def key_result(press: KeyPress, what: str, drives: Mapping[str, KeyPress]) -> CheckResult:
    """Return the row for a driving key."""
    got = velocity_of(press.twist)
    is_ok = is_alike(got, press.wanted) and not (press.twist and misplaced(press.twist))
    cause = key_cause(press, drives)
    measured = velocity_text(got) if got else "nothing comes"
    return CheckResult(what, velocity_text(press.wanted), measured, is_ok, cause.text, cause.key)


def change_result(press: KeyPress, what: str, drives: Mapping[str, KeyPress]) -> CheckResult:
    """Return the row for 'u' after a key that changes a speed; 'u' itself may be wrong."""
    result = key_result(press, what, drives)
    before = drives["u"]
    is_known = is_alike(velocity_of(before.twist), before.wanted)
    if result.is_ok or press.as_capital or not is_known:
        return result
    text = f"'{what.split()[2].rstrip(',')}' should change the speeds by 10 % and keep the motion"
    return replace(result, hint=text, cause=f"change-{what}")
