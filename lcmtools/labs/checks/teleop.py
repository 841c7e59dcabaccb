"""The check of a program that drives by keys: the command for each key."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from lcmtools.labs.checks.checked_programs import CheckedProgram
from lcmtools.labs.checks.diagnosis import misplaced, velocity_of
from lcmtools.labs.checks.driving_keys import (
    DRIVING_KEYS,
    SPEED_KEYS,
    KeyPress,
    Velocity,
    change_result,
    is_alike,
    key_result,
    speeds_result,
)
from lcmtools.labs.checks.program_rows import STOPS, early_end, nothing_within, stop_at_end
from lcmtools.labs.checks.results import CheckResult
from lcmtools.labs.checks.test_bench import TestBench
from lcmtools.labs.nodes.driving.motion import Motion
from lcmtools.types.geometry_msgs import Twist

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
    keyboard.press(key.upper())
    as_capital = key != key.upper() and keyboard.follows(wanted)
    return KeyPress(key, wanted, twist, changes, as_capital)


def _stop_at_end(bench: TestBench, keyboard: _Keyboard) -> CheckResult:
    if keyboard.program.code is not None:
        return early_end(STOPS)
    keyboard.settled("i")
    return stop_at_end(bench)
