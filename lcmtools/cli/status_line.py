"""A status line on a terminal, which is overwritten at each update."""

import shutil
import sys
import time
from contextlib import AbstractContextManager

from lcmtools.cli.output import write_note, write_stderr
from lcmtools.terminal import is_terminal

_SHOWN_EVERY = 0.5  # [s]


class StatusLine(AbstractContextManager["StatusLine"]):
    """A status line on standard error; nothing if quiet, or if that is not a terminal."""

    def __init__(self, command: str, *, is_quiet: bool = False) -> None:
        self._command, self._is_quiet = command, is_quiet
        self.shows = not is_quiet and is_terminal(sys.stderr)
        self._shown = ""
        self._time = 0.0
        self._totals: tuple[int, ...] = ()

    def __exit__(self, *_: object) -> None:
        """Keep the last status, and end the line."""
        if self._shown:
            write_stderr("\n")

    def write(self, text: str) -> None:
        """Overwrite the line."""
        text = text[: shutil.get_terminal_size().columns - 1]
        if self.shows and text != self._shown:
            self._shown = text
            write_stderr(f"\r{text}\x1b[K")

    def clear(self) -> None:
        """Erase the line."""
        if self._shown:
            self._shown = ""
            write_stderr("\r\x1b[K")

    def rates(self, *totals: int) -> list[float]:
        """Return the rates since the last update [1/s], or [] if the line is not due."""
        now = time.monotonic()
        if not self._totals:
            self._time, self._totals = now, totals
        seconds = now - self._time
        if not self.shows or seconds < _SHOWN_EVERY:
            return []
        found = [(new - old) / seconds for new, old in zip(totals, self._totals, strict=True)]
        self._time, self._totals = now, totals
        return found

    def write_note(self, text: str) -> None:
        """Write a note above the line."""
        if self._shown:
            write_stderr("\r\x1b[K")
        write_note(f"{self._command}: {text}")
        if self._shown:
            write_stderr(self._shown)

    def write_note_unless_quiet(self, text: str) -> None:
        """Write a note above the line unless quiet."""
        if not self._is_quiet:
            self.write_note(text)
