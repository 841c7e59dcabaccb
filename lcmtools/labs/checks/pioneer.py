"""The Pioneer lab: the command of each key, and the picture of a depth camera."""

import math
from collections.abc import Iterator, Sequence
from pathlib import Path

from lcmtools.errors import DecodeError
from lcmtools.labs.checks.measures import GOOD, explained
from lcmtools.labs.checks.programs import CheckedProgram, CheckResult
from lcmtools.labs.checks.test_bench import TestBench
from lcmtools.labs.nodes.driving.motion import Motion
from lcmtools.labs.nodes.picture.pixels import Kind, Picture, read_file, read_picture
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import Image

PICTURE = "{picture}"
"""The placeholder in a viewer's command line for the name of the file to save."""
_VELOCITY, _DEPTH = "/RosAria/cmd_vel", "/camera/depth/image_raw"
_FIRST, _NEXT = 10.0, 2.0  # [s] until a key's command comes
_PICTURE = 30.0  # [s] until a picture is whole: a program may take seconds for a PNG
_AGAIN = 0.5  # [s] the first key is pressed again: a program that starts may throw it away
_COLUMNS, _ROWS = 160, 120  # so many pixels are compared
_TOLERANCE = 0.01

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
    """Presses keys, and records the commands that follow."""

    def __init__(self, bench: TestBench, program: CheckedProgram) -> None:
        self._bench = bench
        self.program = program
        self.commands: list[Twist] = bench.record(Twist, _VELOCITY)

    def last(self) -> Velocity | None:
        """Return the newest command since the last key."""
        if not self.commands:
            return None
        twist = self.commands[-1]
        return twist.linear.x, twist.angular.z

    def press(self, key: str) -> None:
        """Press a key."""
        self.commands.clear()
        self.program.press(key)

    def is_answered(self, key: str) -> bool:
        """Return True if pressing a key, again and again, brings a command that moves the robot."""
        for _ in range(round(_FIRST / _AGAIN)):
            self.program.press(key)
            if self._bench.wait(self._moves, _AGAIN) or self.program.code is not None:
                break
        return self._moves()

    def receives(self, wanted: Velocity) -> bool:
        """Return True if the wanted command comes in time."""
        return self._bench.wait(lambda: is_alike(self.last(), wanted), _NEXT)

    def settled(self, key: str) -> Velocity:
        """Press a key; return its command, once no older command is under way."""
        self.press(key)
        self._bench.wait(self.last, _NEXT)
        self._bench.wait(lambda: False, _AGAIN)
        return self.last() or (0.0, 0.0)

    def measured(self) -> str:
        """Return the newest command in words."""
        velocity = self.last()
        return _text(velocity) if velocity else "nothing comes"

    def _moves(self) -> bool:
        return any(self.last() or ())


def is_alike(velocity: Velocity | None, wanted: Velocity) -> bool:
    """Return True if both are the same, but for rounding."""
    return velocity is not None and all(
        math.isclose(value, target, rel_tol=_TOLERANCE, abs_tol=1e-6)
        for value, target in zip(velocity, wanted, strict=True)
    )


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
    speed, turn = keyboard.settled("i")[0], keyboard.settled("j")[1]
    yield CheckResult(
        "speeds of i and j",
        "both above 0",
        _text((speed, turn)),
        is_ok=speed > 0 and turn > 0,
        hint="i is linear.x above 0, j is angular.z above 0: to the left",
    )
    motion = Motion(speed, turn)
    for key, meaning in DIRECTIONS.items():
        yield _key_result(keyboard, key, f"{key}  {meaning}", motion.after(key))
    for key, meaning in SPEED_CHANGES.items():
        motion = motion.after(key)
        program.press(key)
        yield _key_result(keyboard, "u", f"u  after {key}, {meaning}", motion.after("u"))
    yield _stop_at_end(keyboard)


def _key_result(keyboard: _Keyboard, key: str, what: str, motion: Motion) -> CheckResult:
    wanted = motion.forward, motion.turn_rate
    keyboard.press(key)
    is_ok = keyboard.receives(wanted)
    hint = "compare with the table of keys in the lab"
    return CheckResult(what, _text(wanted), keyboard.measured(), is_ok, hint)


def _stop_at_end(keyboard: _Keyboard) -> CheckResult:
    what = "stops at the end"
    if keyboard.program.code is not None:
        return keyboard.program.early_end(what)
    keyboard.settled("i")
    keyboard.commands.clear()
    keyboard.program.ends_on_interrupt()
    stops = keyboard.receives((0.0, 0.0))
    return CheckResult(
        what,
        "a Twist of 0 at last",
        "it comes" if stops else keyboard.measured(),
        is_ok=stops,
        hint="publish a last Twist of 0 in a finally: the robot keeps its last command",
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
    part = _likeness(truths[-1], seen[0]) if bench.wait(lambda: truths, _PICTURE) else 0.0
    yield CheckResult(
        "shows the depth",
        f"{GOOD:.0%} or more alike",
        f"{part:.0%}",
        is_ok=part >= GOOD,
        hint="pixels of the same depth do not look the same: 16UC1 is two bytes a pixel, low byte"
        " first, in mm, 0 for none; rows from the top",
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


def _sampled(picture: Picture) -> Picture:
    grid = picture.image.resize((_COLUMNS, _ROWS), 0)  # 0: the nearest pixel
    return Picture(grid, picture.encoding, picture.kind)
