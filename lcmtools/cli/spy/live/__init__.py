"""The live view of ``lcmtools spy``: the only place that knows textual."""

import os
import sys

from lcmtools.cli.bus import chosen_logs, open_monitor
from lcmtools.cli.output import clearing
from lcmtools.color import stream_wants_color
from lcmtools.errors import UsageError, needing_extra
from lcmtools.observe.channels.columns import TableView
from lcmtools.observe.channels.rows import ChannelSelection


def watch(selection: ChannelSelection, view: TableView) -> int:
    """Show the channels until the user quits, and return the exit code."""
    if chosen_logs():
        raise UsageError("the live view needs a bus", "--once shows the channels of a log")
    if not (sys.stdin.isatty() and sys.stderr.isatty() and clearing()):
        raise UsageError("spy needs a terminal", "--once prints the table")
    with needing_extra("tui", "spy needs", " (--once does without)"):
        from lcmtools.cli.spy.live.app import show
    if not stream_wants_color(sys.stderr, os.environ):
        os.environ["NO_COLOR"] = "1"
    for name in ("COLUMNS", "LINES"):  # textual would keep them as the terminal's size
        os.environ.pop(name, None)
    with open_monitor("spy", plays=True) as monitor:
        return show(monitor, selection, view)
