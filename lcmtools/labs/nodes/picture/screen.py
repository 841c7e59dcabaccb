"""Pictures on a terminal's screen, which is restored; textual-image draws them by its graphics."""

import os
import re
import select
import shutil
import sys
import time
from io import StringIO
from unittest.mock import patch

from rich.console import Console, ConsoleDimensions
from rich.text import Text

from lcmtools.color import stream_wants_color
from lcmtools.labs.nodes.picture.colors import ColoredPicture, ColorOptions, colored, mix
from lcmtools.labs.nodes.picture.display import Display
from lcmtools.labs.nodes.picture.pixels import Picture
from lcmtools.terminal import (
    ESCAPE,
    Terminal,
    TerminalKeys,
    is_terminal,
    read_waiting,
    write_screen,
)

with patch.object(sys, "__stdout__", None):
    # With a terminal there, the import would send queries and wait for the answers for 0.1 s only:
    # later ones, as over a network, would be taken for keys. ``_query`` below waits properly.
    from textual_image._terminal import CellSize, get_cell_size
    from textual_image.renderable import HalfcellImage, SixelImage, TGPImage, UnicodeImage
    from textual_image.renderable._protocol import ImageRenderable

GRAPHICS: dict[str, type[ImageRenderable]] = {
    "blocks": HalfcellImage,
    "sixel": SixelImage,
    "kitty": TGPImage,
}
"""By the value of --graphics."""

_KITTY_QUERY, _KITTY_YES = "\x1b_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\x1b\\", b"\x1b_Gi=31;OK"
_CELL_QUERY, _CELL = "\x1b[16t", re.compile(rb"\x1b\[6;(\d+);(\d+)t")
# Primary device attributes, which every terminal answers; 4 among them are sixels (xterm, Control
# Sequences). Sent last: with their answer all others are there.
_ATTRIBUTES_QUERY, _ATTRIBUTES = "\x1b[c", re.compile(rb"\x1b\[\?([0-9;]*)c")
_SIXEL_ATTRIBUTE = b"4"
_TIMEOUT = 0.5  # [s] for the answers, which may come over a network
_USUAL_CELL = CellSize(8, 16)
_OTHER_SCREEN, _OWN_SCREEN = "\x1b[?1049h\x1b[2J", "\x1b[?1049l"
_HIDE_CURSOR, _SHOW_CURSOR = "\x1b[?25l", "\x1b[?25h"
_HOME, _CLEAR, _CLEAR_LINE, _CLEAR_BELOW = "\x1b[H", "\x1b[2J", "\x1b[K", "\x1b[J"
_MOST_WIDTH, _MOST_HEIGHT = 480, 360  # [pixels] of graphics: more take too long ten times a second
_TEXT_LINES = 2
_LEGEND_WIDTH = 24
_LEGEND_COLUMNS = _LEGEND_WIDTH + len("near 00.5 m  00.5 m far")


class ScreenDisplay(Display):
    """Shows pictures on the terminal's other screen, or a single one, which stays, among the text.

    ``graphics`` is one of GRAPHICS, or "auto" for the best that the terminal has.
    """

    def __init__(self, options: ColorOptions, graphics: str, *, is_single: bool) -> None:
        self._options = options
        self._is_single = is_single
        self._graphics = graphics
        self._has_color = stream_wants_color(sys.stdout, os.environ)
        full = os.environ.get("COLORTERM", "").lower() in ("truecolor", "24bit")
        self._console = Console(
            color_system="truecolor" if full else "256",
            no_color=not self._has_color,
            highlight=False,
            file=StringIO(),  # it only captures, but would flush standard output
            force_terminal=True,
        )
        self._drawing: type[ImageRenderable] = UnicodeImage
        self._has_keys = is_terminal(sys.stdin)
        opening, closing = _HIDE_CURSOR, _SHOW_CURSOR
        if not is_single:
            opening, closing = _OTHER_SCREEN + opening, closing + _OWN_SCREEN
        self._terminal = Terminal(keys=self._has_keys, opening=opening, closing=closing)
        self._keys = TerminalKeys(self._terminal)
        self._size = _screen_size()
        self._title = ""
        self._cell = _USUAL_CELL
        self._shown: Picture | str = ""
        self._drawn: ImageRenderable | None = None

    def open(self, title: str) -> None:
        """Set up the terminal."""
        self._title = title
        self._terminal.__enter__()
        best, self._cell = _query(answers=self._has_keys)
        chosen = best if self._graphics == "auto" else self._graphics
        self._drawing = GRAPHICS[chosen]
        if chosen == "blocks" and not self._has_color:
            self._drawing = UnicodeImage
        if not self._is_single:
            self.show_text("waiting for a picture")

    def show(self, picture: Picture) -> None:
        """Draw a picture."""
        self._shown = picture
        self._draw()

    def show_text(self, text: str) -> None:
        """Write a reason in place of the picture."""
        self._shown = text
        self._draw()

    def attend(self) -> None:
        """Fit a terminal whose size has changed; end on Escape and q."""
        is_resumed = self._terminal.obey()
        if self._has_keys:
            pressed = self._keys.read(0.0)
            self.is_over = self._keys.is_over or bool({"q", "Q", ESCAPE} & set(pressed))
        if not self._is_single and (is_resumed or _screen_size() != self._size):
            self._draw(clears=True)

    def close(self) -> None:
        """Free what the terminal keeps, and restore it."""
        if self._drawn and not self._is_single:
            self._drawn.cleanup()
        self._terminal.__exit__()

    def _draw(self, *, clears: bool = False) -> None:
        """Draw what is shown; ``clears`` the screen first, as another size than before does."""
        size = _screen_size()
        begin = _CLEAR if clears or size != self._size else ""
        self._console.size = self._size = size
        before, self._drawn = self._drawn, None
        with self._console.capture() as capture:
            if isinstance(self._shown, str):
                self._console.print(
                    f"{self._title}: {self._shown}", no_wrap=True, overflow="ellipsis", markup=False
                )
            else:
                self._print(self._shown)
        text = capture.get()
        if not self._is_single:
            lines = text.rstrip("\n").replace("\n", f"{_CLEAR_LINE}\n")
            text = f"{begin}{_HOME}{lines}{_CLEAR_LINE}{_CLEAR_BELOW}"
        try:
            sys.stdout.write(text)
            sys.stdout.flush()
            if before:
                before.cleanup()
        except OSError:  # the terminal is closed
            self.is_over = True

    def _print(self, picture: Picture) -> None:
        """Print the picture, the scale of its colours, and what it is."""
        columns, lines = self._size.width, max(1, self._size.height - _TEXT_LINES)
        shown, size = self._fitted(picture, columns, lines)
        self._drawn = self._drawing(shown.image, *size)
        self._console.print(self._drawn, end="")
        about = f"{self._title}  {picture.image.width} x {picture.image.height} {picture.encoding}"
        self._console.print(self._legend(shown, columns), no_wrap=True, overflow="crop")
        self._console.print(about, no_wrap=True, overflow="crop", markup=False)

    def _fitted(
        self, picture: Picture, columns: int, lines: int
    ) -> tuple[ColoredPicture, tuple[int, int]]:
        """Return the pixels that are shown, in colour, and their size in characters."""
        if self._drawing in (HalfcellImage, UnicodeImage):
            small = picture.fitted(columns, 2 * lines)
            width, height = small.image.size
            return colored(small, self._options), (width, -(-height // 2))
        cell = self._cell
        full = picture.fitted(columns * cell.width, lines * cell.height)
        width, height = full.image.size
        used = max(1, width // cell.width), max(1, height // cell.height)
        small = full.fitted(min(width, _MOST_WIDTH), min(height, _MOST_HEIGHT))
        return colored(small, self._options), used

    def _legend(self, shown: ColoredPicture, columns: int) -> Text:
        """Return the colours of depth with the depths at their ends."""
        if shown.near is None:
            return Text()
        near, far = shown.legend_ends
        if columns < _LEGEND_COLUMNS:  # no room for the colours
            return Text(f"near {near}  far {far}")
        bar = Text(f"near {near} ")
        for step in range(_LEGEND_WIDTH):
            red, green, blue = mix(self._options.color_map, step / (_LEGEND_WIDTH - 1))
            bar.append("\N{FULL BLOCK}", f"rgb({red},{green},{blue})")
        return bar.append(f" {far} far")


def _screen_size() -> ConsoleDimensions:
    """Return the size of the terminal; rich would take COLUMNS and LINES, which do not change."""
    try:
        return ConsoleDimensions(*map(max, os.get_terminal_size(sys.stdout.fileno()), (1, 1)))
    except (OSError, ValueError):
        return ConsoleDimensions(*shutil.get_terminal_size())


def _query(*, answers: bool) -> tuple[str, CellSize]:
    """Return the best of GRAPHICS that the terminal has, and the size of a character [pixels].

    It must hand over keys one by one; what is typed meanwhile is lost. One that cannot be read from
    ``answers`` nothing, and has blocks.
    """
    answer = b""
    if answers:
        write_screen(f"{_KITTY_QUERY}{_CELL_QUERY}{_ATTRIBUTES_QUERY}")
        answer = _read_answer()
    found = _CELL.search(answer)
    cell = CellSize(*(max(1, int(size)) for size in found.group(2, 1))) if found else _USUAL_CELL
    get_cell_size._result = cell  # type: ignore[attr-defined] # noqa: SLF001 - so that it sends no query
    return graphics_in(answer), cell


def graphics_in(answer: bytes) -> str:
    """Return the best graphics that a terminal's answers name."""
    if _KITTY_YES in answer:
        return "kitty"
    attributes = _ATTRIBUTES.search(answer)
    return "sixel" if attributes and _SIXEL_ATTRIBUTE in attributes[1].split(b";") else "blocks"


def _read_answer() -> bytes:
    deadline = time.monotonic() + _TIMEOUT
    answer = b""
    while not _ATTRIBUTES.search(answer) and (left := deadline - time.monotonic()) > 0:
        if select.select([sys.stdin.fileno()], [], [], left)[0]:
            data = read_waiting()
            if not data:
                break
            answer += data
    return answer
