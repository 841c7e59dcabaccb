"""Displays that need no terminal: lines of text, and PNG files."""

import re
import sys
from abc import ABC, abstractmethod
from array import array
from io import BytesIO
from pathlib import Path

import PIL.Image

from lcmtools import Node
from lcmtools.folders import write_whole
from lcmtools.formats.strict_json import write_json
from lcmtools.labs.nodes.picture.colors import ColorOptions, colored, facts, sentence
from lcmtools.messages.pictures import Picture
from lcmtools.messages.pixels import Kind

_NUMBER = re.compile(r"%(0?\d{0,2})[di]")
_COMPRESSION = 1  # of PNG files: a tenth larger than the usual 6, and several times faster


class Display(ABC):
    """A display that shows one picture after another."""

    is_over = False  # True once the user has closed it
    needs_pictures = True  # False if it reads the topic itself
    _text = ""  # the last text

    def open(self, node: Node, topic: str) -> None:  # noqa: B027 - not every display needs it
        """Get ready for the pictures that a node receives on a topic."""

    @abstractmethod
    def show(self, picture: Picture) -> None:
        """Show a picture in place of the one before."""

    def show_text(self, text: str) -> None:
        """Write a text on standard error, unless it was the last one."""
        if text != self._text:
            print(text, file=sys.stderr, flush=True)  # noqa: T201 - a node's own output
        self._text = text

    def attend(self) -> None:  # noqa: B027
        """Handle keys and a change of size; called many times a second."""

    def close(self) -> None:  # noqa: B027
        """Restore the previous state."""


class LineDisplay(Display):
    """A line for each picture, and a PNG file if one is wanted.

    In the path of ``file`` %d counts from 0, %04d with four digits; without one it always has the
    newest picture. With ``as_values`` depth is written in 16-bit millimetres, and not in colour.
    """

    def __init__(self, options: ColorOptions, file: str, *, as_values: bool, as_json: bool) -> None:
        self._options = options
        self._file = file
        self._as_values = as_values
        self._as_json = as_json
        self._count = 0

    def show(self, picture: Picture) -> None:
        """Write the file, and print size, encoding, nearest, farthest and middle."""
        known = facts(picture)
        line = sentence(known)
        if self._file:
            path = numbered(self._file, self._count)
            has_values = self._as_values and picture.kind is not Kind.COLOR
            image = values_of(picture) if has_values else colored(picture, self._options).image
            _write_png(path, image)
            self._count += 1
            known, line = {"file": path, **known}, f"saved {path}  {line}"
        print(write_json(known) if self._as_json else line, flush=True)  # noqa: T201 - a node's own output


def numbered(file: str, number: int) -> str:
    """Replace %d in a file's name by a number."""
    return _NUMBER.sub(lambda match: f"{number:{match[1]}d}", file)


def values_of(picture: Picture) -> PIL.Image.Image:
    """Return depth in 16-bit millimetres, or grey; 0 for what 16 bits cannot hold."""
    values = array("H", (value if value < 1 << 16 else 0 for value in picture.values()))
    if sys.byteorder == "big":
        values.byteswap()  # Pillow's I;16 is little-endian
    return PIL.Image.frombytes("I;16", picture.image.size, values.tobytes())


def _write_png(path: str, image: PIL.Image.Image) -> None:
    """Write a file as a whole: a reader never sees half of it."""
    png = BytesIO()
    image.save(png, "PNG", compress_level=_COMPRESSION)
    write_whole(Path(path), png.getvalue())
