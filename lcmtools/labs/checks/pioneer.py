"""The Pioneer lab: the command of each key, and the picture of a depth camera."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import PIL.Image

from lcmtools.errors import DecodeError
from lcmtools.labs.checks.diagnosis import misplaced
from lcmtools.labs.checks.measures import GOOD, explained
from lcmtools.labs.checks.programs import CheckedProgram
from lcmtools.labs.checks.results import Cause, CheckResult
from lcmtools.labs.checks.test_bench import TestBench
from lcmtools.labs.nodes.driving.motion import Motion
from lcmtools.labs.nodes.picture.pixels import Kind, Picture, read_file, read_picture
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import Image

PICTURE = "{picture}"
"""The placeholder in a viewer's command line for the name of the file to save."""
_VELOCITY, _DEPTH = "/RosAria/cmd_vel", "/camera/depth/image_raw"
_FIRST, _NEXT = 10.0, 2.0  # [s] until a key's command comes
_PICTURE = 15.0  # [s] until a picture is whole: a program may take seconds for a PNG
_STALE = 0.5  # [s] in which commands of the key before may still come
_AGAIN = 0.5  # [s] the first key is pressed again: a program that starts may throw it away
_COLUMNS, _ROWS = 160, 120  # so many pixels are compared
_TOLERANCE = 0.01
_FLIP = PIL.Image.Transpose

DIRECTIONS = {
    "i": "forward",
    ",": "backward",
    "j": "left on the spot",
    "l": "right on the spot",
    "u": "forward to the left",
    "o": "forward to the right",
    "m": "backward, clockwise",
    ".": "backward, counter-clockwise",
    "k": "stop",
}
"""Meanings of the keys that drive, which are those of teleop_twist_keyboard."""
SPEED_CHANGES = {
    "q": "both 10 % more",
    "z": "both 10 % less",
    "w": "speed 10 % more",
    "x": "speed 10 % less",
    "e": "turning 10 % more",
    "c": "turning 10 % less",
}
"""Meanings of the keys that change a speed."""

Velocity = tuple[float, float]
"""Forward speed [m/s] and turn rate [rad/s], positive to the left."""


class _Keyboard:
    """Presses keys, and watches the commands that follow."""

    def __init__(self, bench: TestBench, program: CheckedProgram) -> None:
        self._bench = bench
        self._first = 0
        self._patience = _NEXT
        self.program = program
        bench.record_command(Twist)

    def last(self) -> Twist | None:
        """Return the newest command since the last key."""
        commands = self._bench.commands
        message = commands[-1].message if len(commands) > self._first else None
        return message if isinstance(message, Twist) else None

    def press(self, key: str) -> None:
        """Press a key; what came before counts no longer."""
        self._first = len(self._bench.commands)
        self.program.press(key)

    def is_answered(self, key: str) -> bool:
        """Return True if pressing a key, again and again, brings a command that moves the robot."""
        for _ in range(round(_FIRST / _AGAIN)):
            self.program.press(key)
            if self._bench.wait(self._moves, _AGAIN) or self.program.code is not None:
                break
        return self._moves()

    def receives(self, wanted: Velocity) -> bool:
        """Return True if the wanted command comes in time, or another one and not this."""
        if not self._bench.wait(self.last, self._patience):
            self._patience = _STALE  # for the other keys: there may be many that it does not know
            return False
        return self._bench.wait(lambda: is_alike(_velocity(self.last()), wanted), _STALE)

    def settled(self, key: str) -> Velocity:
        """Press a key; return its command, once no older command is under way."""
        self.press(key)
        self._bench.wait(self.last, _NEXT)
        self._bench.wait(lambda: False, _STALE)
        return _velocity(self.last()) or (0.0, 0.0)

    def measured(self) -> str:
        """Return the newest command in words."""
        velocity = _velocity(self.last())
        return _text(velocity) if velocity else "nothing comes"

    def _moves(self) -> bool:
        return any(_velocity(self.last()) or ()) or bool(self._odd())

    def _odd(self) -> Cause | None:
        twist = self.last()
        return misplaced(twist) if twist else None


def _velocity(twist: Twist | None) -> Velocity | None:
    return (twist.linear.x, twist.angular.z) if twist else None


def is_alike(velocity: Velocity | None, wanted: Velocity) -> bool:
    """Return True if both are the same, but for rounding."""
    return velocity is not None and all(
        math.isclose(value, target, rel_tol=_TOLERANCE, abs_tol=1e-6)
        for value, target in zip(velocity, wanted, strict=True)
    )


@dataclass(frozen=True, slots=True)
class KeyPress:
    """A key that was pressed, the command that it is to bring, and the one that came, if any."""

    key: str
    wanted: Velocity
    twist: Twist | None


def key_cause(press: KeyPress, drives: Mapping[str, KeyPress]) -> Cause:
    """Return why a key brought the wrong command, by what the keys that drive brought."""
    key, wanted, got = press.key, press.wanted, _velocity(press.twist)
    if press.twist is None or got is None:
        text = f"nothing is published for '{key}': is each key read at once, and is it known?"
        return Cause("unanswered", text)
    if odd := misplaced(press.twist):
        return odd
    for index, name in enumerate(("speed", "turn")):
        if _is_reversed(drives, index) and is_alike(got, _reversed(wanted, index)):
            side = ("forward is linear.x above 0", "left is angular.z above 0")[index]
            return Cause(f"{name}-sign", f"wrong sign of {name}: {side}")
    other = next((k for k, one in drives.items() if k != key and is_alike(got, one.wanted)), "")
    if not any(got):
        text = f"'{key}' stops the robot: is it in the program's table of keys?"
        return Cause(f"key-{key}", text)
    if other:
        pair = "".join(sorted((key, other)))
        text = f"'{key}' does what '{other}' should do ({DIRECTIONS[other]})"
        return Cause(f"key-{pair}", f"{text}: one key for another")
    return Cause(f"key-{key}", f"compare '{key}' with the table of keys in the lab")


def _is_reversed(drives: Mapping[str, KeyPress], index: int) -> bool:
    """Return True if most keys bring the opposite of what they should, in speed or in turn."""
    moving = [one for one in drives.values() if one.wanted[index]]
    wrong = [
        one
        for one in moving
        if one.twist and (_velocity(one.twist) or (0, 0))[index] * one.wanted[index] < 0
    ]
    return len(wrong) > len(moving) / 2


def _reversed(velocity: Velocity, index: int) -> Velocity:
    return (-velocity[0], velocity[1]) if index == 0 else (velocity[0], -velocity[1])


def check_teleop(bench: TestBench, command: Sequence[str]) -> Iterator[CheckResult]:
    """Check a program that drives by keys."""
    program = bench.start(command, has_keys=True)
    keyboard = _Keyboard(bench, program)
    what, wanted = "answers to i", "a Twist"
    if not keyboard.is_answered("i"):
        hint = f"read single keys, without Enter (tty.setcbreak), and publish on {_VELOCITY}"
        yield program.nothing_within(_FIRST, what, wanted, f"{hint} after each")
        return
    yield CheckResult(what, wanted, "it comes", is_ok=True)
    speed, turn = abs(keyboard.settled("i")[0]) or 0.5, abs(keyboard.settled("j")[1]) or 1.0
    motion = Motion(speed, turn)
    drives = {}
    for key in DIRECTIONS:  # all are pressed before one is judged: the others show the cause
        motion = motion.after(key)
        drives[key] = _pressed(keyboard, key, motion)
    yield _speeds_result(drives)
    for key, meaning in DIRECTIONS.items():
        yield _key_result(drives[key], f"{key}  {meaning}", drives)
    if program.code is not None:
        yield program.early_end("answers to all keys")
        return
    for key, meaning in SPEED_CHANGES.items():
        motion = motion.after(key)
        program.press(key)
        motion = motion.after("u")
        press = _pressed(keyboard, "u", motion)
        yield _change_result(press, f"u  after {key}, {meaning}", drives)
        speed, turn = map(abs, _velocity(press.twist) or (0.0, 0.0))
        if speed and turn:  # one wrong change does not make the next ones wrong
            motion = replace(motion, speed=speed, turn=turn)
    yield _stop_at_end(keyboard)


def _speeds_result(drives: Mapping[str, KeyPress]) -> CheckResult:
    i, j = (_velocity(drives[key].twist) or (0.0, 0.0) for key in "ij")
    speeds = i[0], j[1]
    cause = key_cause(drives["i" if speeds[0] <= 0 else "j"], drives)
    is_ok = min(speeds) > 0
    what, wanted = "speeds of i and j", "both above 0"
    return CheckResult(what, wanted, _text(speeds), is_ok, cause.text, cause.key)


def _pressed(keyboard: _Keyboard, key: str, motion: Motion) -> KeyPress:
    wanted = motion.forward, motion.turn_rate
    keyboard.press(key)
    keyboard.receives(wanted)
    return KeyPress(key, wanted, keyboard.last())


def _key_result(press: KeyPress, what: str, drives: Mapping[str, KeyPress]) -> CheckResult:
    got = _velocity(press.twist)
    is_ok = is_alike(got, press.wanted) and not (press.twist and misplaced(press.twist))
    cause = key_cause(press, drives)
    measured = _text(got) if got else "nothing comes"
    return CheckResult(what, _text(press.wanted), measured, is_ok, cause.text, cause.key)


def _change_result(press: KeyPress, what: str, drives: Mapping[str, KeyPress]) -> CheckResult:
    """Return the result of 'u' after a key that changes a speed; 'u' itself may be wrong."""
    result = _key_result(press, what, drives)
    before = drives["u"]
    if result.is_ok or not is_alike(_velocity(before.twist), before.wanted):
        return result
    text = f"'{what.split()[2].rstrip(',')}' is to change the speeds by 10 %, and keep the motion"
    return replace(result, hint=text, cause=f"change-{what}")


def _stop_at_end(keyboard: _Keyboard) -> CheckResult:
    what = "stops at the end"
    if keyboard.program.code is not None:
        return keyboard.program.early_end(what)
    keyboard.settled("i")
    keyboard.press("")
    keyboard.program.ends_on_interrupt()
    stops = keyboard.receives((0.0, 0.0))
    return CheckResult(
        what,
        "a Twist of 0 at last",
        "it comes" if stops else keyboard.measured(),
        is_ok=stops,
        hint="publish a last Twist of 0 in a finally: the robot keeps its last command",
        cause="no-stop",
    )


def _text(velocity: Velocity) -> str:
    return "{:+.3f} m/s, {:+.3f} rad/s".format(*velocity)


def viewer_command(words: Sequence[str], picture: str) -> list[str]:
    """Return a viewer's command line, with the file that it is to save."""
    if any(PICTURE in word for word in words):
        return [word.replace(PICTURE, picture) for word in words]
    return [*words, "--save", picture]


def check_viewer(bench: TestBench, command: Sequence[str]) -> Iterator[CheckResult]:
    """Check a program that saves the Kinect's picture as a PNG file."""
    truths = bench.record(Image, _DEPTH)
    file = bench.folder / "picture.png"
    program = bench.start(viewer_command(command, str(file)))
    seen: list[Picture] = []  # a viewer may rewrite the file with each message

    def has_come() -> bool:
        seen.extend(filter(None, [_read(file)]))
        return bool(seen)

    bench.wait(lambda: has_come() or program.code is not None, _PICTURE)
    what, wanted = "saves a picture", "a PNG file"
    if not has_come() and file.exists():
        hint = "save it as PNG or JPEG"
        yield CheckResult(what, wanted, "a file that is no picture", is_ok=False, hint=hint)
        return
    if not seen:
        hint = f"does it subscribe to {_DEPTH}, and save what comes where --save or {PICTURE} says?"
        yield program.nothing_within(_PICTURE, what, wanted, hint)
        return
    yield CheckResult(what, wanted, "{} x {} pixels".format(*seen[0].image.size), is_ok=True)
    part, reason = 0.0, ""
    if bench.wait(lambda: truths, _PICTURE):
        part = _likeness(truths[-1], seen[0])
        reason = picture_cause(truths[-1], seen[0]) if part < GOOD else ""
    yield CheckResult(
        "shows the depth",
        f"{GOOD:.0%} or more alike",
        f"{part:.0%}",
        is_ok=part >= GOOD,
        hint=reason
        or "pixels of the same depth do not look the same: 16UC1 is two bytes a pixel, low byte"
        " first, in mm, 0 for none; rows from the top",
        cause="picture",
    )
    if program.code is None:
        yield program.check_ctrl_c()


def _read(file: Path) -> Picture | None:
    """Return the picture; None while it is not there, or not whole."""
    try:
        return read_file(file.read_bytes())
    except (OSError, DecodeError):
        return None


def _likeness(truth: Image, picture: Picture) -> float:
    """Return the part of the colours that the true depths explain, at points of a grid."""
    depths = _sampled(read_picture(truth)).values()
    shown = _sampled(picture)
    if shown.kind is not Kind.COLOR:
        return explained(depths, [(value,) for value in shown.values()])
    channels = shown.image.tobytes()
    return explained(depths, list(zip(channels[::3], channels[1::3], channels[2::3], strict=True)))


_TURNED: Mapping[str, Callable[[PIL.Image.Image], PIL.Image.Image]] = {
    "upside down: rows go from the top": lambda i: i.transpose(_FLIP.FLIP_TOP_BOTTOM),
    "mirrored: columns go from the left": lambda i: i.transpose(_FLIP.FLIP_LEFT_RIGHT),
    "turned by 180 degrees: the first pixel is at the top left": lambda i: i.transpose(
        _FLIP.ROTATE_180
    ),
    "turned by 90 degrees: data is row by row, not column by column": lambda i: i.transpose(
        _FLIP.TRANSPOSE
    ),
}


def picture_cause(truth: Image, picture: Picture) -> str:
    """Return the way in which a picture is turned; "" if it is in no such way."""
    if picture.image.getextrema() in ((0, 0), ((0, 0),) * 3):
        return "the picture is all black: is it the data of a message, and in a visible range?"
    for name, turn in _TURNED.items():
        turned = Picture(turn(picture.image), picture.encoding, picture.kind)
        if _likeness(truth, turned) >= GOOD:
            return f"the picture is {name}"
    return ""


def _sampled(picture: Picture) -> Picture:
    grid = picture.image.resize((_COLUMNS, _ROWS), 0)  # 0: the nearest pixel
    return Picture(grid, picture.encoding, picture.kind)
