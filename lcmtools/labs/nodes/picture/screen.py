"""Pictures on a terminal's screen, which they fit; the screen is given back as it was."""

import os
import sys

from lcmtools.color import stream_wants_color
from lcmtools.labs.nodes.driving.keyboard import TerminalKeys
from lcmtools.labs.nodes.driving.keys import ESCAPE
from lcmtools.labs.nodes.picture import graphics, kitty
from lcmtools.labs.nodes.picture.blocks import LEGEND_WIDTH, color_depth, draw_blocks, draw_legend
from lcmtools.labs.nodes.picture.kitty import draw_kitty
from lcmtools.labs.nodes.picture.pixels import Picture
from lcmtools.labs.nodes.picture.sample import Look, View, fitting_size, take_view
from lcmtools.labs.nodes.picture.sixel import draw_sixel
from lcmtools.labs.nodes.picture.words import legend_ends
from lcmtools.labs.nodes.terminal import Terminal, is_terminal

_OTHER_SCREEN, _OWN_SCREEN = "\x1b[?1049h\x1b[2J", "\x1b[?1049l"
_HIDE_CURSOR, _SHOW_CURSOR = "\x1b[?25l", "\x1b[?25h"
_HOME, _CLEAR, _CLEAR_LINE, _CLEAR_BELOW = "\x1b[H", "\x1b[2J", "\x1b[K", "\x1b[J"
_MOST_WIDTH, _MOST_HEIGHT = 480, 360  # [pixels] of graphics: more take too long ten times a second
_WORDS_LINES = 2
_LEGEND_COLUMNS = LEGEND_WIDTH + len("near 00.5 m  00.5 m far")


class ScreenDisplay:
    """Shows pictures on the terminal's other screen, or one of them among the text.

    Args:
        look: The colours.
        chosen: Graphics, of ``graphics.CHOICES``.
        is_single: One picture is shown, and stays.
    """

    def __init__(self, look: Look, chosen: str, *, is_single: bool) -> None:
        self.is_over = False
        self._look = look
        self._graphics = chosen
        self._is_single = is_single
        self._depth = color_depth(
            dict(os.environ), wanted=stream_wants_color(sys.stdout, os.environ)
        )
        self._has_keys = is_terminal(sys.stdin)
        opening, closing = _HIDE_CURSOR, _SHOW_CURSOR
        if not is_single:
            opening, closing = _OTHER_SCREEN + opening, closing + _OWN_SCREEN
        self._terminal = Terminal(keys=self._has_keys, opening=opening, closing=closing)
        self._keys = TerminalKeys(self._terminal)
        self._size = (0, 0)
        self._title = ""
        self._shown: Picture | str = ""

    def open(self, title: str) -> None:
        """See Display."""
        self._title = title
        self._terminal.__enter__()
        if self._graphics == graphics.AUTO:
            self._graphics = graphics.ask_graphics() if self._has_keys else graphics.BLOCKS
        if not self._is_single:
            self.say("waiting for a picture")

    def show(self, picture: Picture) -> None:
        """See Display."""
        self._shown = picture
        self._draw()

    def say(self, text: str) -> None:
        """Say it in place of the picture."""
        self._shown = text
        self._draw()

    def attend(self) -> None:
        """Fit a terminal whose size has changed; Escape and q end."""
        is_resumed = self._terminal.obey()
        if self._has_keys:
            pressed = self._keys.read(0.0)
            self.is_over = self._keys.is_over or bool({"q", "Q", ESCAPE} & set(pressed))
        if not self._is_single and (is_resumed or graphics.screen_size() != self._size):
            self._draw()

    def close(self) -> None:
        """See Display."""
        if self._graphics == graphics.KITTY and not self._is_single:
            self._write(kitty.CLEAR)
        self._terminal.__exit__()

    def _draw(self) -> None:
        size = graphics.screen_size()
        begin = "" if self._is_single else _HOME + (_CLEAR if size != self._size else "")
        if size != self._size and self._graphics == graphics.KITTY:
            begin += kitty.CLEAR
        self._size = size
        columns, lines = size
        if isinstance(self._shown, str):
            self._write(f"{begin}{f'{self._title}: {self._shown}'[:columns]}{_CLEAR_BELOW}\n")
            return
        picture = self._shown
        body = self._body(picture, columns, max(1, lines - _WORDS_LINES))
        end = "\n" if self._is_single else ""
        self._write(f"{begin}{body}{end}")

    def _body(self, picture: Picture, columns: int, lines: int) -> str:
        if self._graphics == graphics.BLOCKS:
            view = take_view(picture, self._look, *fitting_size(picture, columns, 2 * lines))
            drawn = draw_blocks(view, self._depth)
            return _joined([*drawn, *self._words(view, picture, columns)])
        width, height = graphics.cell_size()
        shown = fitting_size(picture, columns * width, lines * height)
        view = take_view(picture, self._look, *_at_most(*shown))
        used = max(1, shown[0] // width), max(1, shown[1] // height)
        words = _joined(self._words(view, picture, columns))
        if self._graphics == graphics.KITTY:
            # room is made first, so that a picture at the bottom of the screen scrolls up
            below = "\n" * used[1]
            return f"{below}\x1b[{used[1]}A{draw_kitty(view, *used)}\x1b[{used[1]}B\r{words}"
        if not self._is_single:
            used_lines = -(-view.height // height)
            return f"{draw_sixel(view)}\x1b[{used_lines + 1}H{words}"
        return f"{draw_sixel(view)}\r\n{words}"

    def _words(self, view: View, picture: Picture, columns: int) -> list[str]:
        """The two lines below the picture: the scale, and what it is."""
        legend = draw_legend(view, self._depth)
        if legend and columns < _LEGEND_COLUMNS:  # no room for the bar
            legend = "near {}  far {}".format(*legend_ends(view.scale))[: columns - 1]
        about = f"{self._title}  {picture.width} x {picture.height} {picture.encoding}"
        return [legend, about[: columns - 1]]

    def _write(self, text: str) -> None:
        try:
            sys.stdout.write(text)
            sys.stdout.flush()
        except OSError:  # the terminal is closed
            self.is_over = True


def _joined(lines: list[str]) -> str:
    """Lines, each clearing what was behind it, the last one what was below."""
    return f"{_CLEAR_LINE}\r\n".join(lines) + _CLEAR_LINE + _CLEAR_BELOW


def _at_most(width: int, height: int) -> tuple[int, int]:
    scale = min(1.0, _MOST_WIDTH / width, _MOST_HEIGHT / height)
    return max(1, round(width * scale)), max(1, round(height * scale))
