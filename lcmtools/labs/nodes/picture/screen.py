"""Pictures on a terminal's screen, which is restored: a character shows two pixels of a column."""

import os
import shutil
import sys
from collections.abc import Mapping, Sequence
from enum import Enum
from itertools import chain

import PIL.Image

from lcmtools import Node
from lcmtools.color import stream_wants_color
from lcmtools.labs.nodes.picture.colors import ColoredPicture, ColorOptions, colored, mix
from lcmtools.labs.nodes.picture.display import Display
from lcmtools.messages.pictures import Picture
from lcmtools.terminal import ESCAPE, Terminal, TerminalKeys, is_terminal

_UPPER_HALF = "\N{UPPER HALF BLOCK}"
_RESET = "\x1b[0m"
_SHADES = " \N{LIGHT SHADE}\N{MEDIUM SHADE}\N{DARK SHADE}\N{FULL BLOCK}"  # from dark to bright
# xterm's colours 16 to 255: a cube of six levels each of red, green and blue, then 24 greys
_FIRST = 16
_LEVELS = (0, 95, 135, 175, 215, 255)
_CUBE = [(red, green, blue) for red in _LEVELS for green in _LEVELS for blue in _LEVELS]
_GREYS = [(grey, grey, grey) for grey in range(8, 248, 10)]


class TerminalColors(Enum):
    """The colours that a terminal shows."""

    NONE = "none"
    INDEXED = "256"
    FULL = "24 bits"


def terminal_colors(environment: Mapping[str, str], *, wants_color: bool) -> TerminalColors:
    """Return the colours of the terminal that an environment describes, if colour is wanted."""
    if not wants_color:
        return TerminalColors.NONE
    has_all = environment.get("COLORTERM", "").lower() in ("truecolor", "24bit")
    return TerminalColors.FULL if has_all else TerminalColors.INDEXED


def blocks(image: PIL.Image.Image, colors: TerminalColors) -> list[str]:
    """Return an RGB image as lines, each of two rows of pixels."""
    width, height = image.width, -(-image.height // 2)
    even = image.crop((0, 0, width, 2 * height))  # a row that is missing becomes black
    if colors is TerminalColors.NONE:
        grey = even.convert("L").resize((width, height), PIL.Image.Resampling.BOX).tobytes()
        shades = "".join(_SHADES[level * len(_SHADES) // 256] for level in grey)
        return [shades[start : start + width] for start in range(0, len(shades), width)]
    codes = _indexed(even) if colors is TerminalColors.INDEXED else _full(even)
    rows = [codes[start : start + width] for start in range(0, len(codes), width)]
    return [_line(upper, lower) for upper, lower in zip(rows[::2], rows[1::2], strict=True)]


def _full(image: PIL.Image.Image) -> list[str]:
    """Return the colour of each pixel as in an escape sequence."""
    data = image.tobytes()
    pixels = zip(data[::3], data[1::3], data[2::3], strict=True)
    return [f"2;{red};{green};{blue}" for red, green, blue in pixels]


def _indexed(image: PIL.Image.Image) -> list[str]:
    """Return the nearest of xterm's colours for each pixel, likewise."""
    palette = PIL.Image.new("P", (1, 1))
    palette.putpalette([*chain.from_iterable(_CUBE + _GREYS)])
    nearest = image.quantize(palette=palette, dither=PIL.Image.Dither.NONE).tobytes()
    return [f"5;{_FIRST + index}" for index in nearest]


def _line(upper: Sequence[str], lower: Sequence[str]) -> str:
    """Return the characters of two rows; a colour is written only where it changes."""
    parts = []
    before = ("", "")
    for pair in zip(upper, lower, strict=True):
        if pair != before:
            parts.append(f"\x1b[38;{pair[0]};48;{pair[1]}m")
            before = pair
        parts.append(_UPPER_HALF)
    return "".join([*parts, _RESET])


_OTHER_SCREEN, _OWN_SCREEN = "\x1b[?1049h\x1b[2J", "\x1b[?1049l"
_HIDE_CURSOR, _SHOW_CURSOR = "\x1b[?25l", "\x1b[?25h"
_HOME, _CLEAR, _CLEAR_LINE, _CLEAR_BELOW = "\x1b[H", "\x1b[2J", "\x1b[K", "\x1b[J"
_TEXT_LINES = 2
_LEGEND_WIDTH = 24
_LEGEND_COLUMNS = _LEGEND_WIDTH + len("near 00.5 m  00.5 m far")


class ScreenDisplay(Display):
    """Shows pictures on the terminal's other screen, or a single one that stays among the text.

    ``note`` follows the facts below a picture.
    """

    def __init__(self, options: ColorOptions, *, is_single: bool, note: str = "") -> None:
        self._options = options
        self._note = note
        self._is_single = is_single
        self._colors = terminal_colors(
            os.environ, wants_color=stream_wants_color(sys.stdout, os.environ)
        )
        self._has_keys = is_terminal(sys.stdin)
        opening, closing = _HIDE_CURSOR, _SHOW_CURSOR
        if not is_single:
            opening, closing = _OTHER_SCREEN + opening, closing + _OWN_SCREEN
        self._terminal = Terminal(keys=self._has_keys, opening=opening, closing=closing)
        self._keys = TerminalKeys(self._terminal)
        self._size = _screen_size()
        self._title = ""
        self._shown: Picture | str = ""

    def open(self, node: Node, topic: str) -> None:  # noqa: ARG002 - other displays need the node
        """Set up the terminal."""
        self._title = topic
        self._terminal.__enter__()
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
        """Restore the terminal."""
        self._terminal.__exit__()

    def _draw(self, *, clears: bool = False) -> None:
        """Draw what is shown; ``clears`` the screen first, as another size than before does."""
        size = _screen_size()
        begin = _CLEAR if clears or size != self._size else ""
        self._size = size
        lines = self._lines(self._shown)
        if self._is_single:
            text = "".join(f"{line}\n" for line in lines)
        else:
            text = "".join([begin, _HOME, "\n".join(lines), _CLEAR_BELOW])
        try:
            sys.stdout.write(text)
            sys.stdout.flush()
        except OSError:  # the terminal is closed
            self.is_over = True

    def _lines(self, shown: Picture | str) -> list[str]:
        """Return the lines of a text; or of a picture, the scale of its colours, and its facts."""
        columns, lines = self._size
        if isinstance(shown, str):
            return [self._fitted(f"{self._title}: {shown}")]
        small = colored(shown.fitted(columns, 2 * max(1, lines - _TEXT_LINES)), self._options)
        # in the last column, the cursor is on the last character, which would be cleared
        end = _CLEAR_LINE if small.image.width < columns else ""
        about = f"{self._title}  {shown.image.width} x {shown.image.height} {shown.encoding}"
        about += f"  {self._note}" if self._note else ""
        drawn = [f"{line}{end}" for line in blocks(small.image, self._colors)]
        return [*drawn, self._legend(small), self._fitted(about)]

    def _fitted(self, text: str) -> str:
        """Return a line of text that fits, and clears the rest of its line."""
        room = max(1, self._size.columns - 1)
        return f"{text if len(text) <= room else text[: room - 1] + '…'}{_CLEAR_LINE}"

    def _legend(self, shown: ColoredPicture) -> str:
        """Return the colours of depth with the depths at their ends."""
        if shown.near is None:
            return _CLEAR_LINE
        near, far = shown.legend_ends
        if self._size.columns <= _LEGEND_COLUMNS:  # no room for the colours
            return self._fitted(f"near {near}  far {far}")
        bar = PIL.Image.new("RGB", (_LEGEND_WIDTH, 2))
        for step in range(_LEGEND_WIDTH):
            color = mix(self._options.color_map, step / (_LEGEND_WIDTH - 1))
            bar.paste(color, (step, 0, step + 1, 2))
        return f"near {near} {blocks(bar, self._colors)[0]} {far} far{_CLEAR_LINE}"


def _screen_size() -> os.terminal_size:
    """Return the terminal's size: COLUMNS and LINES, which do not change, are second choice."""
    try:
        columns, lines = os.get_terminal_size(sys.stdout.fileno())
    except (OSError, ValueError):
        return shutil.get_terminal_size()
    return os.terminal_size((max(1, columns), max(1, lines)))
