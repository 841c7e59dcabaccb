"""The line that shows where a player is, on a terminal, beside what else is said."""

import contextlib
import sys
from contextlib import AbstractContextManager

from lcmtools.bag.keys import KEYS_HELP
from lcmtools.bag.player import Position
from lcmtools.cli.output import talk
from lcmtools.terminal import has_keys, is_terminal


class ProgressLine(AbstractContextManager["ProgressLine"]):
    """A line on standard error that is written over; nothing where that is no terminal.

    Args:
        command: The name before what is said.
        is_quiet: Show no line.
    """

    def __init__(self, command: str, *, is_quiet: bool) -> None:
        self._command, self._is_quiet = command, is_quiet
        self._shows = not is_quiet and is_terminal(sys.stderr)
        self._shown = ""
        self._has_helped = not (self._shows and has_keys())

    def __exit__(self, *_: object) -> None:
        """Leave the last line where it is."""
        if self._shown:
            _write("\n")

    def show(self, position: Position) -> None:
        """Show where the player is."""
        if not self._has_helped:
            self._has_helped = True
            talk(KEYS_HELP)
        text = position_text(position)
        if self._shows and text != self._shown:
            self._shown = text
            _write(f"\r{text}\x1b[K")

    def talk(self, text: str) -> None:
        """Say something above the line."""
        if self._shown:
            _write("\r\x1b[K")
        talk(f"{self._command}: {text}")
        if self._shown:
            _write(self._shown)

    def talk_unless_quiet(self, text: str) -> None:
        """Say something that is no warning."""
        if not self._is_quiet:
            self.talk(text)


def position_text(position: Position) -> str:
    """Return "45.2 / 75.8 s", with the rate where it is not 1."""
    rate = "" if position.rate == 1 else f"  x{position.rate:g}" if position.rate else "  at once"
    paused = "  paused" if position.is_paused else ""
    return f"{position.seconds:.1f} / {position.length:.1f} s{rate}{paused}"


def _write(text: str) -> None:
    with contextlib.suppress(OSError, ValueError):  # the terminal is closed
        sys.stderr.write(text)
        sys.stderr.flush()
