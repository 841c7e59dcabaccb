"""The check of a program that drives by keys: their meanings, and the command for each."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

from lcmtools.labs.checks.checked_programs import CheckedProgram
from lcmtools.labs.checks.diagnosis import misplaced, velocity_of
from lcmtools.labs.checks.measures import velocity_text
from lcmtools.labs.checks.program_rows import STOPS, early_end, nothing_within, stop_at_end
from lcmtools.labs.checks.results import Cause, CheckResult
from lcmtools.labs.checks.test_bench import TestBench
from lcmtools.labs.nodes.driving.motion import DIRECTIONS, SPEED_CHANGES, Motion
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


_FIRST, _NEXT = 10.0, 2.0  # [s] until a key's command comes
_STALE = 0.5  # [s] in which commands of the key before may still come
_TYPING = 0.13  # [s] from a command to the next key: getch() throws away what comes between calls,
# and so does teleop_twist_keyboard, which polls for 0.1 s
_PRESSES = 2  # of a key: one may be thrown away
_AGAIN = 0.5  # [s] the first key is pressed again: a program that starts may throw it away


class _Keyboard:
    """Presses keys, and watches the commands that follow."""

    def __init__(self, bench: TestBench, program: CheckedProgram) -> None:
        self._bench = bench
        self._first = 0
        self._patience = _NEXT
        self.program = program
        bench.recorder.record_command(Twist)

    def last(self) -> Twist | None:
        """Return the newest command since the last key."""
        return self.newest() if len(self._bench.recorder.commands) > self._first else None

    def newest(self) -> Twist | None:
        """Return the newest command, also of an earlier key."""
        commands = self._bench.recorder.commands
        message = commands[-1].message if commands else None
        return message if isinstance(message, Twist) else None

    def press(self, key: str) -> None:
        """Press a key and ignore earlier commands."""
        self._bench.wait(lambda: False, _TYPING)
        self._first = len(self._bench.recorder.commands)
        self.program.press(key)

    def is_answered(self, key: str) -> bool:
        """Press a key repeatedly; return True when a command moves the robot."""
        for _ in range(round(_FIRST / _AGAIN)):
            self.program.press(key)
            if self._bench.wait(self._moves, _AGAIN) or self.program.code is not None:
                break
        return self._moves()

    def receives(self, wanted: Velocity) -> bool:
        """Return True if the wanted command comes in time; False for none or another one."""
        if not self._bench.wait(self.last, self._patience):
            self._patience = _STALE  # for the other keys: there may be many that it does not know
            return False
        return self.follows(wanted)

    def follows(self, wanted: Velocity) -> bool:
        """Return True if the wanted command comes soon."""
        return self._bench.wait(lambda: is_alike(velocity_of(self.last()), wanted), _STALE)

    def settled(self, key: str) -> Velocity:
        """Press a driving key; return its command when no older one can arrive."""
        for _ in range(_PRESSES):
            self.press(key)
        self._bench.wait(self.last, _NEXT)
        self._bench.wait(lambda: False, _STALE)
        return velocity_of(self.last()) or (0.0, 0.0)

    def _moves(self) -> bool:
        twist = self.last()
        return twist is not None and bool(any(velocity_of(twist) or ()) or misplaced(twist))


def check_teleop(bench: TestBench, command: Sequence[str]) -> Iterator[CheckResult]:
    """Check a program that drives by keys."""
    program = bench.start(command, has_keys=True)
    keyboard = _Keyboard(bench, program)
    what, wanted = "answers to i", "a Twist"
    if not keyboard.is_answered("i"):
        if keyboard.last():
            hint = "'i' stops the robot: is it in the program's table of keys, in lower case?"
            yield CheckResult(what, "a speed above 0", "a Twist of 0", is_ok=False, hint=hint)
            return
        hint = "read single keys, without Enter (cbreak mode), and publish on /RosAria/cmd_vel"
        yield nothing_within(program, _FIRST, what, wanted, f"{hint} after each")
        return
    yield CheckResult(what, wanted, "it comes", is_ok=True)
    speed, turn = abs(keyboard.settled("i")[0]) or 0.5, abs(keyboard.settled("j")[1]) or 1.0
    motion = Motion(speed, turn)
    drives = {}
    for key in DRIVING_KEYS:  # all are pressed before one is judged: the others show the cause
        motion = motion.after(key)
        drives[key] = _pressed(keyboard, key, motion)
    yield speeds_result(drives)
    for key, meaning in DRIVING_KEYS.items():
        yield key_result(drives[key], f"{key}  {meaning}", drives)
    if program.code is not None:
        yield early_end("answers to all keys")
        return
    for key, meaning in SPEED_KEYS.items():
        press, motion = _changed(bench, keyboard, key, motion)
        yield change_result(press, f"u  after {key}, {meaning}", drives)
        speed, turn = map(abs, velocity_of(press.twist) or (0.0, 0.0))
        if speed and turn:  # one wrong change does not make the next ones wrong
            motion = replace(motion, speed=speed, turn=turn)
    yield _stop_at_end(bench, keyboard)


def _changed(
    bench: TestBench, keyboard: _Keyboard, key: str, motion: Motion
) -> tuple[KeyPress, Motion]:
    """Press a speed key and u; return the press of u and the expected motion."""
    before, wanted = motion.after("u"), motion.after(key).after("u")
    for name in (key, key, key.upper()):
        keyboard.press(name)
        bench.wait(keyboard.last, _STALE)  # select() does not see keys that input has buffered
        press = _pressed(keyboard, "u", wanted, is_whole=True)
        if not is_alike(velocity_of(press.twist), (before.forward, before.turn_rate)):
            break
    is_right = is_alike(velocity_of(press.twist), press.wanted)
    return replace(press, as_capital=is_right and name != key), wanted


def _pressed(keyboard: _Keyboard, key: str, motion: Motion, *, is_whole: bool = False) -> KeyPress:
    """Press a driving key; if it is wrong and not ``is_whole``, find out what does what it should.

    A program that goes on with its commands seems to answer to a key that it does not know.
    """
    wanted, before = (motion.forward, motion.turn_rate), velocity_of(keyboard.newest())
    for _ in range(_PRESSES):
        keyboard.press(key)
        if keyboard.receives(wanted):
            return KeyPress(key, wanted, keyboard.last())
    twist, changes = keyboard.last(), True
    if is_whole:
        return KeyPress(key, wanted, twist)
    if before and is_alike(velocity_of(twist), before):
        other = keyboard.settled("," if key == "i" else "i")
        keyboard.press(key)
        keyboard.follows(wanted)
        again = velocity_of(keyboard.last())
        changes = again is not None and not is_alike(again, other)
    as_capital = False
    if key != key.upper() and not (changes and any(velocity_of(twist) or ())):
        keyboard.press(key.upper())
        as_capital = keyboard.follows(wanted)
    return KeyPress(key, wanted, twist, changes, as_capital)


def _stop_at_end(bench: TestBench, keyboard: _Keyboard) -> CheckResult:
    if keyboard.program.code is not None:
        return early_end(STOPS)
    keyboard.settled("i")
    return stop_at_end(bench)
