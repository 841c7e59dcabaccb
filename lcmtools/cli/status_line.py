"""A line on a terminal that shows a state and is written over, beside what else is said."""

import contextlib
import shutil
import sys
from contextlib import AbstractContextManager

from lcmtools.cli.output import talk
from lcmtools.terminal import is_terminal


class StatusLine(AbstractContextManager["StatusLine"]):
    """A line on standard error that is written over; nothing if quiet, or that is no terminal."""

    def __init__(self, command: str, *, is_quiet: bool = False) -> None:
        self._command, self._is_quiet = command, is_quiet
        self.shows = not is_quiet and is_terminal(sys.stderr)
        self._shown = ""

    def __exit__(self, *_: object) -> None:
        """Leave the last line where it is."""
        if self._shown:
            _write("\n")

    def write(self, text: str) -> None:
        """Write the line."""
        text = text[: shutil.get_terminal_size().columns - 1]
        if self.shows and text != self._shown:
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


def _write(text: str) -> None:
    with contextlib.suppress(OSError, ValueError):  # the terminal is closed
        sys.stderr.write(text)
        sys.stderr.flush()
