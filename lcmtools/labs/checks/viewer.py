"""The check of a viewer: its saved picture of a depth camera."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

import PIL.Image

from lcmtools.errors import LcmtoolsError
from lcmtools.folders import read_bytes
from lcmtools.labs.checks.diagnosis import UNLIKE
from lcmtools.labs.checks.measures import GOOD, explained
from lcmtools.labs.checks.program_rows import first
from lcmtools.labs.checks.results import CheckResult
from lcmtools.labs.checks.test_bench import TestBench
from lcmtools.messages.pictures import Picture, read_file, read_picture
from lcmtools.messages.pixels import Kind
from lcmtools.types.sensor_msgs import Image

PICTURE = "{picture}"  # the placeholder in a viewer's command line for the name of the file to save
_DEPTH = "/camera/depth/image_raw"
_PICTURE = 15.0  # [s] until a picture is whole: a program may take seconds for a PNG
_COLUMNS, _ROWS = 160, 120  # so many pixels are compared
_CONTRAST = 25  # of 255: the difference of brightness that can be seen
_MOST_BYTES = 100_000_000  # of the picture
_FLIP = PIL.Image.Transpose
_NO_CONTRAST = "near and far hardly differ: scale some 5000 mm to 255, not to 65535"


def viewer_command(words: Sequence[str], picture: str) -> list[str]:
    """Return a viewer's command line with the file to save."""
    if any(PICTURE in word for word in words):
        return [word.replace(PICTURE, picture) for word in words]
    return [*words, "--save", picture]


def check_viewer(bench: TestBench, command: Sequence[str]) -> Iterator[CheckResult]:
    """Check a program that saves the Kinect's picture as a file."""
    truths = bench.recorder.record(Image, _DEPTH)
    file = bench.folder / "picture.png"
    bench.start(viewer_command(command, str(file)))
    seen: list[Picture] = []  # a viewer may rewrite the file with each message

    def has_come() -> bool:
        seen.extend(filter(None, [_read(file)]))
        return bool(seen)

    what, wanted = "saves a picture", "an image file"
    hint = f"does it subscribe to {_DEPTH}, and save the picture where --save or {PICTURE} says?"
    row = CheckResult(what, wanted, "it comes", is_ok=True, hint=hint)
    row = first(bench, has_come, _PICTURE, row)
    if not row.is_ok and file.exists():
        hint = "save it as PNG, JPEG or PGM"
        yield CheckResult(what, wanted, "a file that is not a picture", is_ok=False, hint=hint)
        return
    if not row.is_ok:
        yield row
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
        or "pixels of about the same depth do not look alike: 16UC1 is two bytes a pixel, low byte"
        " first, in mm, 0 for none: scale it to 255 at most; rows from the top",
        cause=UNLIKE,
    )
    if part >= GOOD:
        contrast = _contrast(truths[-1], seen[0])
        what, wanted, hint = "has contrast", f"{_CONTRAST} or more of 255", _NO_CONTRAST
        yield CheckResult(what, wanted, f"{contrast}", contrast >= _CONTRAST, hint)


def _read(file: Path) -> Picture | None:
    """Read the picture; None while it is missing or incomplete."""
    try:
        return read_file(read_bytes(file, _MOST_BYTES))
    except LcmtoolsError:
        return None


def _likeness(truth: Image, picture: Picture) -> float:
    """Return the fraction of the colours that the true depths explain, at points of a grid."""
    return explained(_sampled(read_picture(truth)).values(), _colors(picture))


def _contrast(truth: Image, picture: Picture) -> int:
    """Return the difference of brightness among most points that have a depth, of 255.

    A file of 16 bits holds the depths themselves.
    """
    if picture.kind is Kind.DEPTH:
        return 255
    depths = _sampled(read_picture(truth)).values()
    colors = [color for depth, color in zip(depths, _colors(picture), strict=True) if depth]
    few = len(colors) // 20
    channels = map(sorted, zip(*colors, strict=True))
    return max((channel[-1 - few] - channel[few] for channel in channels), default=0)


def _colors(picture: Picture) -> list[tuple[int, ...]]:
    """Return the one or three channels of each point of a grid."""
    shown = _sampled(picture)
    if shown.kind is not Kind.COLOR:
        return [(value,) for value in shown.values()]
    channels = shown.image.tobytes()
    return list(zip(channels[::3], channels[1::3], channels[2::3], strict=True))


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
    """Return the way in which a picture is turned; "" if it is not."""
    if picture.image.getextrema() in ((0, 0), ((0, 0),) * 3):
        return "the picture is all black: is it the data of a message, and in a visible range?"
    if picture.image.size == (truth.height, truth.width) != (truth.width, truth.height):
        return f"width and height are exchanged: it is {truth.width} wide, {truth.height} high"
    for name, turn in _TURNED.items():
        turned = Picture(turn(picture.image), picture.encoding, picture.kind)
        if _likeness(truth, turned) >= GOOD:
            return f"the picture is {name}"
    return ""


def _sampled(picture: Picture) -> Picture:
    grid = picture.image.resize((_COLUMNS, _ROWS), 0)  # 0: the nearest pixel
    return Picture(grid, picture.encoding, picture.kind)
