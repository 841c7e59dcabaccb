"""The output of ``lcmtools launch``: the lines and events of all processes."""

import os
import sys

from lcmtools.cli.output import write_data, write_note, write_stderr
from lcmtools.color import BOLD_RED, paint, stream_wants_color
from lcmtools.escapes import ESCAPES, escape_but_colors
from lcmtools.launch.node_process import NodeProcess

_COLORS = ("36", "32", "35", "34", "33")  # of nodes in turn: red is for what is wrong


class Screen:
    """Shows the lines and events of a supervisor on one screen, with prefixes and colours.

    Lines of a node's error stream and events go to standard error, the rest to standard output.
    """

    def __init__(self) -> None:
        self._colors_lines = stream_wants_color(sys.stdout, os.environ)
        self._colors_talk = stream_wants_color(sys.stderr, os.environ)

    def line(self, node: NodeProcess, text: str, *, is_error: bool) -> None:
        """Write a node's line with its colours; what else would control the terminal is escaped."""
        text = escape_but_colors(text)
        prefix = f"[{node.label}]"
        if self._colors_talk if is_error else self._colors_lines:
            prefix = paint(prefix, _COLORS[node.number % len(_COLORS)])
        if not is_error:
            write_data(f"{prefix} {text}")
            return
        write_stderr(f"{prefix} {text}\n")

    def stream(self, *, is_error: bool) -> int:
        """Return the file descriptor of the output."""
        return (sys.stderr if is_error else sys.stdout).fileno()

    def event(self, text: str, *, is_bad: bool = False) -> None:
        """Write an event of the processes."""
        if is_bad and self._colors_talk:
            write_stderr(f"{paint(text.translate(ESCAPES), BOLD_RED)}\n")
        else:
            write_note(text)
