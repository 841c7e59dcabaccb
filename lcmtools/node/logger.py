"""A node's log, written to standard error in ROS's format and to ``/rosout``."""

import inspect
import math
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import TextIO

from lcmtools import errors
from lcmtools.clock import Clock, split_stamp
from lcmtools.color import RED, YELLOW, paint, stream_wants_color
from lcmtools.errors import explained
from lcmtools.escapes import ESCAPES_IN_LINES
from lcmtools.types.rosgraph_msgs import Log

_LABELS = {getattr(Log, name): name for name in ("DEBUG", "INFO", "WARN", "ERROR", "FATAL")}
_COLORS = {Log.WARN: YELLOW, Log.ERROR: RED, Log.FATAL: RED}

Place = tuple[str, int, str]
"""A place in the code: its file, the line, and the function."""


class Logger:
    """Writes a node's log, to standard error by default; ``Node.get_logger`` returns it.

    ``forward`` is called with each entry (for ``/rosout``).
    """

    def __init__(
        self, node: str, clock: Clock, forward: Callable[[Log], None], stream: TextIO | None = None
    ) -> None:
        self.threshold = Log.INFO
        """Entries below this level are only forwarded, not printed."""
        self._node = node
        self.clock = clock
        """Stamps the entries."""
        self._forward = forward
        self._stream = stream
        self._last_printed: dict[Place, float] = {}

    @explained
    def debug(self, text: str, *, once: bool = False, throttle: float = 0.0) -> None:
        """Log a debugging aid; for the options see ``info``."""
        self._log(Log.DEBUG, text, math.inf if once else throttle)

    @explained
    def info(self, text: str, *, once: bool = False, throttle: float = 0.0) -> None:
        """Log a normal event.

        Args:
            text: The line.
            once: Log only the first time that this place in the code is reached.
            throttle: Log from this place in the code at most once in this many seconds.
        """
        self._log(Log.INFO, text, math.inf if once else throttle)

    @explained
    def warning(self, text: str, *, once: bool = False, throttle: float = 0.0) -> None:
        """Log a possible fault."""
        self._log(Log.WARN, text, math.inf if once else throttle)

    warn = warning

    def repeat(self, text: str) -> None:
        """Publish a warning that still holds again on ``/rosout``, without printing it."""
        self._log(Log.WARN, text, prints=False)

    @explained
    def error(self, text: str, *, once: bool = False, throttle: float = 0.0) -> None:
        """Log a fault."""
        self._log(Log.ERROR, text, math.inf if once else throttle)

    def error_at(self, place: Place, text: str) -> None:
        """Log a fault at a place in the code other than the caller's."""
        self._log(Log.ERROR, text, place=place)

    def error_again(self, text: str) -> None:
        """Print another line about a fault that ``/rosout`` has already; it is not forwarded."""
        self._log(Log.ERROR, text, forwards=False)

    @explained
    def fatal(self, text: str, *, once: bool = False, throttle: float = 0.0) -> None:
        """Log a fault that the node cannot survive."""
        self._log(Log.FATAL, text, math.inf if once else throttle)

    def _log(
        self,
        level: int,
        text: str,
        throttle: float = 0.0,
        *,
        prints: bool = True,
        forwards: bool = True,
        place: Place | None = None,
    ) -> None:
        place = place or _place_of_call()
        if throttle > 0 and not self._is_time(place, throttle):
            return
        text = str(text)  # any object may be logged: a log raises no errors
        entry = Log()
        entry.header.stamp.sec, entry.header.stamp.nsec = split_stamp(self.clock.now())
        entry.level, entry.name = level, self._node
        entry.msg = sendable(text)
        file, entry.line, entry.function = place
        entry.file = sendable(Path(file).name)
        stream = self._stream or sys.stderr
        if prints and level >= self.threshold and stream:  # None: closed before the program began
            _print(entry, text, stream)
        if forwards:
            self._forward(entry)

    def _is_time(self, place: Place, throttle: float) -> bool:
        now = time.monotonic()
        last = self._last_printed.get(place)
        if last is not None and now - last < throttle:
            return False
        self._last_printed[place] = now
        return True


def _place_of_call() -> Place:
    """Return the place that called a method of the log."""
    frame = inspect.currentframe()
    while frame and frame.f_code.co_filename in (__file__, errors.__file__):
        frame = frame.f_back
    code = frame and frame.f_code
    return (code.co_filename, frame.f_lineno, code.co_name) if frame and code else ("", 0, "")


def sendable(text: str) -> str:
    """Return a text that can be sent as UTF-8, which names of files may not be."""
    return text.encode("utf-8", "replace").decode()


def _print(entry: Log, text: str, stream: TextIO) -> None:
    """Print an entry as ROS does; if a disk is full, a robot's controller goes on.

    Raises:
        BrokenPipeError: The reader of the log has ended.
    """
    stamp = entry.header.stamp
    shown = text.translate(ESCAPES_IN_LINES)  # it may be from a message
    line = f"[{_LABELS[entry.level]}] [{stamp.sec}.{stamp.nsec:09d}] [{entry.name}]: {shown}"
    color = _COLORS.get(entry.level)
    if color and stream_wants_color(stream, os.environ):
        line = paint(line, color)
    try:
        stream.write(f"{line}\n")  # one write, so that lines of several threads do not mix
        stream.flush()
    except BrokenPipeError:
        raise
    except (OSError, ValueError):  # a full disk, most likely, or the program has closed the stream
        return
