"""Where pictures go that no terminal shows: lines of text, and PNG files.

Data to standard output; what it looks like on a terminal's screen is ``screen``'s business.
"""

import json
import os
import re
import sys
from pathlib import Path
from typing import Protocol

from lcmtools.errors import LcmtoolsError
from lcmtools.labs.nodes.picture.pixels import Picture
from lcmtools.labs.nodes.picture.png import PngPixels, encode_png
from lcmtools.labs.nodes.picture.sample import Look, take_view
from lcmtools.labs.nodes.picture.words import facts, sentence

_NUMBER = re.compile(r"%(0?\d{0,2})[di]")


class Display(Protocol):
    """Something that shows one picture after the other.

    Attributes:
        is_over: Nobody looks any more.
    """

    is_over: bool

    def open(self, title: str) -> None:
        """Get ready; the title is the topic."""
        ...

    def show(self, picture: Picture) -> None:
        """Show a picture in place of the one before."""
        ...

    def say(self, text: str) -> None:
        """Say why there is no picture."""
        ...

    def attend(self) -> None:
        """Look after what the person does; called many times a second."""
        ...

    def close(self) -> None:
        """Leave all as it was."""
        ...


class LineDisplay:
    """A line for each picture: its size, encoding, nearest, farthest and middle.

    Args:
        as_json: In JSON.
    """

    def __init__(self, *, as_json: bool = False) -> None:
        self.is_over = False
        self._as_json = as_json
        self._said = ""

    def open(self, title: str) -> None:
        """See Display."""

    def show(self, picture: Picture) -> None:
        """See Display."""
        known = facts(picture)
        print_line(json.dumps(known) if self._as_json else sentence(known))

    def say(self, text: str) -> None:
        """Say it on standard error, once."""
        if text != self._said:
            sys.stderr.write(f"{text}\n")
            sys.stderr.flush()
        self._said = text

    def attend(self) -> None:
        """See Display."""

    def close(self) -> None:
        """See Display."""


class FileDisplay(LineDisplay):
    """Writes each picture into a PNG file, and a line about it.

    Args:
        file: Its path; %d in it counts from 0, %04d with four digits. Without one, the file always
            has the newest picture.
        look: The colours.
        as_values: Depth is written as it is, 16 bits in millimetres, and not in colour.
        as_json: The lines are JSON.
    """

    def __init__(self, file: str, look: Look, *, as_values: bool, as_json: bool = False) -> None:
        super().__init__(as_json=as_json)
        self._file = file
        self._look = look
        self._as_values = as_values
        self._as_json = as_json
        self._count = 0

    def show(self, picture: Picture) -> None:
        """Write it."""
        path = numbered(self._file, self._count)
        pixels = values_of(picture) if self._as_values else None
        write_file(path, encode_png(pixels or colors_of(picture, self._look)))
        self._count += 1
        known = {"file": path, **facts(picture)}
        print_line(json.dumps(known) if self._as_json else f"saved {path}  {sentence(known)}")


def numbered(file: str, number: int) -> str:
    """A file's name with a number in place of its %d."""
    return _NUMBER.sub(lambda match: f"{number:{match[1]}d}", file)


def colors_of(picture: Picture, look: Look) -> PngPixels:
    """A picture as it is shown, in its own size."""
    view = take_view(picture, look, picture.width, picture.height)
    return PngPixels(view.width, view.height, 3, 8, view.to_bytes())


def values_of(picture: Picture) -> PngPixels | None:
    """Depth in millimetres, what 16 bits cannot hold being 0; None for colours."""
    rows: list[bytes] = []
    for y in range(picture.height):
        row = [value if isinstance(value, int) else -1 for value in picture.row(y)]
        if -1 in row:
            return None
        rows.append(b"".join((v if v < 1 << 16 else 0).to_bytes(2, "big") for v in row))
    return PngPixels(picture.width, picture.height, 1, 16, b"".join(rows))


def write_file(path: str, content: bytes) -> None:
    """Write a file whole: whoever looks into it meanwhile sees the one before.

    Raises:
        LcmtoolsError: It cannot be written.
    """
    draft = Path(f"{path}.part")
    try:
        draft.write_bytes(content)
        os.replace(draft, path)  # noqa: PTH105 - the path may be relative, as typed
    except OSError as error:
        draft.unlink(missing_ok=True)
        raise LcmtoolsError(f"cannot write {path}: {error.strerror}") from error


def print_line(text: str) -> None:
    """Write a line of data at once."""
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()
