"""A node's log: to standard error in ROS's manner, and to ``/rosout``."""

import inspect
import os
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path
from typing import TextIO

from lcmtools.clock import Clock, split_stamp
from lcmtools.color import RED, YELLOW, paint, stream_wants_color
from lcmtools.types.rosgraph_msgs import Log


class Severity(IntEnum):
    """The severity of an entry; the constants of rosgraph_msgs/Log."""

    DEBUG = 1
    INFO = 2
    WARN = 4
    ERROR = 8
    FATAL = 16


@dataclass(frozen=True, slots=True)
class LogEntry:
    """One entry of a log."""

    severity: Severity
    time: int  # nanoseconds on the node's clock
    node: str  # its full name
    text: str  # a line, or lines
    file: str = ""  # source file, function and line that logged it
    function: str = ""
    line: int = 0

    def __str__(self) -> str:
        """Return it in ROS's format."""
        sec, nsec = split_stamp(self.time)
        return f"[{self.severity.name}] [{sec}.{nsec:09d}] [{self.node}]: {self.text}"


_COLORS = {Severity.WARN: YELLOW, Severity.ERROR: RED, Severity.FATAL: RED}


def _print(entry: LogEntry, stream: TextIO | None) -> None:
    """Print an entry, on a terminal in color; without room on a disk, a robot's controller goes on.

    Raises:
        BrokenPipeError: The reader of the log has ended.
    """
    if stream is None:  # standard error was closed before the program began
        return
    color = _COLORS.get(entry.severity)
    is_colored = color and stream_wants_color(stream, os.environ)
    try:
        # one write: lines of several threads do not mix
        stream.write(f"{paint(str(entry), color) if color and is_colored else entry}\n")
        stream.flush()
    except BrokenPipeError:
        raise
    except OSError:  # a full disk, most likely
        return


def log_message(entry: LogEntry) -> Log:
    """Return the message of an entry for ``/rosout``."""
    message = Log()
    message.header.stamp.sec, message.header.stamp.nsec = split_stamp(entry.time)
    message.level, message.name = entry.severity, entry.node
    message.msg = entry.text.encode("utf-8", "replace").decode()  # file names may be no UTF-8
    message.file, message.function, message.line = entry.file, entry.function, entry.line
    return message


class Logger:
    """Writes a node's log. Made by the node; ``Node.get_logger`` returns it.

    Args:
        node: The node's full name.
        clock: Stamps the entries.
        forward: Called with each entry (for ``/rosout``).
        stream: The output; standard error when None.
    """

    def __init__(
        self,
        node: str,
        clock: Clock,
        forward: Callable[[LogEntry], None],
        stream: TextIO | None = None,
    ) -> None:
        self.threshold = Severity.INFO
        """Entries below this severity are forwarded and not printed."""
        self._node = node
        self.clock = clock
        """Stamps the entries."""
        self._forward = forward
        self._stream = stream
        self._last_printed: dict[tuple[str, int], float] = {}

    def debug(self, text: str, *, once: bool = False, throttle: float = 0.0) -> None:
        """Log an aid to debugging; for the options see ``info``."""
        self._log(Severity.DEBUG, text, once=once, throttle=throttle)

    def info(self, text: str, *, once: bool = False, throttle: float = 0.0) -> None:
        """Log a normal event.

        Args:
            text: The line.
            once: Only the first time that this place in the code is reached.
            throttle: At most once in so many seconds from this place in the code.
        """
        self._log(Severity.INFO, text, once=once, throttle=throttle)

    def warning(self, text: str, *, once: bool = False, throttle: float = 0.0) -> None:
        """Log a possible fault."""
        self._log(Severity.WARN, text, once=once, throttle=throttle)

    warn = warning

    def error(self, text: str, *, once: bool = False, throttle: float = 0.0) -> None:
        """Log a fault."""
        self._log(Severity.ERROR, text, once=once, throttle=throttle)

    def fatal(self, text: str, *, once: bool = False, throttle: float = 0.0) -> None:
        """Log a fault that the node cannot survive."""
        self._log(Severity.FATAL, text, once=once, throttle=throttle)

    def _log(self, severity: Severity, text: str, *, once: bool, throttle: float) -> None:
        frame = inspect.currentframe()
        caller = frame.f_back.f_back if frame and frame.f_back else None
        place = (caller.f_code.co_filename, caller.f_lineno) if caller else ("", 0)
        if (once or throttle > 0) and not self._is_time(place, once=once, throttle=throttle):
            return
        entry = LogEntry(
            severity,
            self.clock.now(),
            self._node,
            str(text),  # of any object; a log raises nothing
            Path(place[0]).name,
            caller.f_code.co_name if caller else "",
            place[1],
        )
        if severity >= self.threshold:
            _print(entry, self._stream or sys.stderr)
        self._forward(entry)

    def _is_time(self, place: tuple[str, int], *, once: bool, throttle: float) -> bool:
        now = time.monotonic()
        last = self._last_printed.get(place)
        if last is not None and (once or now - last < throttle):
            return False
        self._last_printed[place] = now
        return True
