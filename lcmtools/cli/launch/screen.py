"""The lines of several processes on one screen.

Belongs here: prefixes and colours. A process's errors go to standard error, the rest to standard
output; what happens to the processes is told on standard error.
"""

import contextlib
import os
import sys

from lcmtools.cli.output import data, talk
from lcmtools.color import BOLD_RED, paint, stream_wants_color
from lcmtools.launch.supervisor import label
from lcmtools.processes.process import Process

_COLORS = ("36", "32", "35", "34", "33")  # of nodes in turn: red is for what is wrong


class Screen:
    """Shows what a supervisor tells."""

    def __init__(self) -> None:
        self._colors_lines = stream_wants_color(sys.stdout, os.environ)
        self._colors_talk = stream_wants_color(sys.stderr, os.environ)

    def line(self, process: Process, text: str, *, is_error: bool) -> None:
        """Show a line that a process has written; it is the node's own, and not changed.

        Raises:
            BrokenPipeError: Nobody reads any more.
        """
        prefix = f"[{label(process)}]"
        if self._colors_talk if is_error else self._colors_lines:
            prefix = paint(prefix, _COLORS[process.number % len(_COLORS)])
        if not is_error:
            data(f"{prefix} {text}")
            return
        with contextlib.suppress(OSError):
            sys.stderr.write(f"{prefix} {text}\n")
            sys.stderr.flush()

    def stream(self, *, is_error: bool) -> int:
        """The descriptor that is written into."""
        return (sys.stderr if is_error else sys.stdout).fileno()

    def event(self, text: str, *, is_bad: bool = False) -> None:
        """Say what has happened to the processes."""
        if is_bad and self._colors_talk:
            with contextlib.suppress(OSError):
                sys.stderr.write(f"{paint(text, BOLD_RED)}\n")
                sys.stderr.flush()
        else:
            talk(text)
