"""The Pioneer lab: does each key command what the table says, and is the depth picture right."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from lcmtools.errors import DecodeError
from lcmtools.labs.checks.keys import DIRECTIONS, FACTORS, STOP, Command, after, changed
from lcmtools.labs.checks.measures import GOOD, explained
from lcmtools.labs.checks.programs import CheckedProgram
from lcmtools.labs.checks.row import Row, ends_on_ctrl_c, fate, row
from lcmtools.labs.checks.stage import Stage
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


class _Keyboard:
    """Presses keys, and knows what the robot was told last."""

    def __init__(self, stage: Stage, program: CheckedProgram) -> None:
        self._stage = stage
        self.program = program
        self.last: Command | None = None
        stage.listen(Twist, _VELOCITY, self._take)

    def is_answered(self, key: str) -> bool:
        """Return whether pressing a key, again and again, brings a command that moves the robot."""
        for _ in range(round(_FIRST / _AGAIN)):
            self.program.press(key)
            if self._stage.wait(self._moves, _AGAIN) or self.program.code is not None:
                break
        return self._moves()

    def press(self, key: str, wanted: Command) -> bool:
        """Press a key; whether what is wanted comes in time."""
        self.last = None
        self.program.press(key)
        return self.comes(wanted)

    def comes(self, wanted: Command) -> bool:
        """Return whether a command comes in time."""
        return self._stage.wait(lambda: self.last is not None and self.last.is_like(wanted), _NEXT)

    def settled(self, key: str) -> Command | None:
        """The command of a key, once no older command is under way."""
        self.last = None
        self.program.press(key)
        self._stage.wait(lambda: self.last is not None, _NEXT)
        self._stage.wait(lambda: False, _AGAIN)
        return self.last

    def told(self) -> str:
        """The last command to the robot, in words."""
        return str(self.last) if self.last else "nothing comes"

    def _moves(self) -> bool:
        return self.last is not None and self.last != Command(0.0, 0.0)

    def _take(self, twist: Twist) -> None:
        self.last = Command(twist.linear.x, twist.angular.z)


def check_teleop(stage: Stage, command: Sequence[str]) -> Iterator[Row]:
    """Rows about a program that drives by keys."""
    program = stage.start(command, has_keys=True)
    keyboard = _Keyboard(stage, program)
    first = _first_key(keyboard)
    yield first
    if not first.is_ok:
        return
    ahead, around = keyboard.settled("i"), keyboard.settled("j")
    speeds = Command(ahead.forward if ahead else 0.0, around.turn_rate if around else 0.0)
    yield _speeds_row(speeds)
    for key, (_, _, meaning) in DIRECTIONS.items():
        yield _key_row(keyboard, key, meaning, after(key, speeds))
    yield _key_row(keyboard, STOP, "stop", Command(0.0, 0.0))
    for key, (_, _, meaning) in FACTORS.items():
        speeds = changed(key, speeds)
        program.press(key)
        yield _key_row(keyboard, "u", f"after {key}, {meaning}", after("u", speeds))
    yield _ending(keyboard)


def _first_key(keyboard: _Keyboard) -> Row:
    is_ok = keyboard.is_answered("i")
    what, wanted = "answers to i", "a Twist"
    if not is_ok and keyboard.program.code is not None:
        return fate(what, keyboard.program, wanted)
    hint = f"read single keys, without Enter (tty.setcbreak), and publish on {_VELOCITY} after each"
    return row(what, wanted, "it comes" if is_ok else "nothing comes", is_ok=is_ok, hint=hint)


def _speeds_row(speeds: Command) -> Row:
    return row(
        "speeds of i and j",
        "both above 0",
        str(speeds),
        is_ok=speeds.forward > 0 and speeds.turn_rate > 0,
        hint="i is linear.x above 0, j is angular.z above 0: to the left",
    )


def _key_row(keyboard: _Keyboard, key: str, meaning: str, wanted: Command) -> Row:
    comes = keyboard.press(key, wanted)
    return row(
        f"{key}  {meaning}",
        str(wanted),
        keyboard.told(),
        is_ok=comes,
        hint="compare with the table of keys in the lab",
    )


def _ending(keyboard: _Keyboard) -> Row:
    if keyboard.program.code is not None:
        return fate("stands at the end", keyboard.program)
    keyboard.settled("i")
    keyboard.last = None
    keyboard.program.ends_on_interrupt()
    stands = keyboard.comes(Command(0.0, 0.0))
    return row(
        "stands at the end",
        "a Twist of 0 at last",
        "it comes" if stands else keyboard.told(),
        is_ok=stands,
        hint="publish a last Twist of 0 in a finally: the robot keeps its last command",
    )


def viewer_command(words: Sequence[str], picture: str) -> list[str]:
    """A viewer's command line, with the file that it is to save."""
    if any(PICTURE in word for word in words):
        return [word.replace(PICTURE, picture) for word in words]
    return [*words, "--save", picture]


def check_viewer(stage: Stage, command: Sequence[str]) -> Iterator[Row]:
    """Rows about a program that saves the Kinect's picture as a PNG file."""
    truths: list[Image] = []
    stage.listen(Image, _DEPTH, truths.append)
    file = stage.folder / "picture.png"
    program = stage.start(viewer_command(command, str(file)))
    seen: list[Picture] = []  # a viewer may rewrite the file with each message

    def has_come() -> bool:
        seen.extend(filter(None, [_read(file)]))
        return bool(seen)

    stage.wait(lambda: has_come() or program.code is not None, _PICTURE)
    picture = seen[0] if has_come() else None
    what, wanted = "saves a picture", "a PNG file"
    if picture is None:
        yield _no_picture(what, wanted, file, program)
        return
    yield row(what, wanted, "{} x {} pixels".format(*picture.image.size), is_ok=True, hint="")
    truth_came = stage.wait(lambda: truths, _PICTURE)
    part = _likeness(truths[-1], picture) if truth_came else 0.0
    yield row(
        "shows the depth",
        f"{GOOD:.0%} or more alike",
        f"{part:.0%}",
        is_ok=part >= GOOD,
        hint="pixels of the same depth do not look the same: 16UC1 is two bytes a pixel, low byte"
        " first, in mm, 0 for none; rows from the top",
    )
    if program.code is None:
        yield ends_on_ctrl_c(program)


def _no_picture(what: str, wanted: str, file: Path, program: CheckedProgram) -> Row:
    if file.exists():
        hint = "save it as PNG or JPEG"
        return Row(what, wanted, "a file that is no picture", is_ok=False, hint=hint)
    if program.code is not None:
        return fate(what, program, wanted)
    hint = f"does it subscribe to {_DEPTH}, and save what comes where --save or {PICTURE} says?"
    return Row(what, wanted, f"none within {_PICTURE:g} s", is_ok=False, hint=hint)


def _read(file: Path) -> Picture | None:
    """The picture; None while it is not there, or not whole."""
    try:
        return read_file(file.read_bytes())
    except (OSError, DecodeError):
        return None


def _likeness(truth: Image, picture: Picture) -> float:
    """The part of the picture's colours that the true depths explain, at points of a grid."""
    depths = _sampled(read_picture(truth)).values()
    shown = _sampled(picture)
    if shown.kind is not Kind.COLOR:
        return explained(depths, [(value,) for value in shown.values()])
    channels = shown.image.tobytes()
    return explained(depths, list(zip(channels[::3], channels[1::3], channels[2::3], strict=True)))


def _sampled(picture: Picture) -> Picture:
    grid = picture.image.resize((_COLUMNS, _ROWS), 0)  # 0: the nearest pixel
    return Picture(grid, picture.encoding, picture.kind)
