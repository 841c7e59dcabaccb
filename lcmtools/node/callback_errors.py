"""The exceptions that a node's callbacks raise: logged once each, then counted and announced.

A callback that fails at 50 Hz would otherwise fill the terminal with one traceback.
"""

import os
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import TracebackType

from lcmtools.bounded import BoundedDict
from lcmtools.graph.model import CallbackError
from lcmtools.message_value import name_fields
from lcmtools.node.logger import Logger, Place, sendable

_MOST_KEPT = 100  # different errors of one node
_MOST_ANNOUNCED = 5
_MESSAGE_CHARACTERS = 200
_FIRST_PAUSE, _LONGEST_PAUSE = 1.0, 60.0  # [s] between two lines about the same error
_PACKAGE = Path(__file__).parent.parent
_PROGRAMS = _PACKAGE / "labs"  # programs as users write them


@dataclass(slots=True)
class _Seen:
    due: float  # of the next log line, on the monotonic clock [s]
    pause: float = _FIRST_PAUSE
    message: str = ""
    last_time: int = 0
    count: int = 0
    reported: int = 1


class CallbackErrors:
    """The exceptions of one node's callbacks.

    Each different error is logged once with its traceback, then as a line with its count, at
    growing intervals. ``announce`` is called for each error that differs from those before.
    """

    def __init__(self, logger: Logger, announce: Callable[[], None]) -> None:
        self._logger = logger
        self._announce = announce
        # by callback, class and place
        self._seen = BoundedDict[tuple[str, str, str], _Seen](_MOST_KEPT)

    def add(self, callback: str, error: BaseException, function: object) -> None:
        """Log and count one exception of a callback, named as in ``CallbackError``."""
        name_fields(error)
        place = place_of(error, function)
        key = (callback, type(error).__name__, sendable(f"{Path(place[0]).name}:{place[1]}"))
        now, seen = time.monotonic(), self._seen.get(key)
        if seen is None:
            seen = self._seen[key] = _Seen(now + _FIRST_PAUSE)
            trace = "".join(traceback.format_exception(type(error), error, _users_part(error)))
            text = f"{_words(callback)} raised {key[1]}: {error}\n{trace.rstrip()}"
            self._logger.error_at(place, text)
        seen.message = sendable(str(error).partition("\n")[0][:_MESSAGE_CHARACTERS])
        seen.count, seen.last_time = seen.count + 1, time.time_ns()
        if seen.count == 1:
            self._announce()
        elif now >= seen.due:
            seen.pause = min(2 * seen.pause, _LONGEST_PAUSE)
            seen.due = now + seen.pause
            self._report(key, seen)

    def report(self) -> None:
        """Log how often each error was raised since its last line; called when the node ends."""
        for key, seen in tuple(self._seen.items()):
            if seen.count > seen.reported:
                self._report(key, seen)

    def newest(self) -> tuple[CallbackError, ...]:
        """Return the newest different errors, the last one last; callable from any thread."""
        errors = (
            CallbackError(callback, exception, seen.message, place, seen.count, seen.last_time)
            for (callback, exception, place), seen in tuple(self._seen.items())
            if seen.count
        )
        return tuple(sorted(errors, key=lambda error: error.last_time)[-_MOST_ANNOUNCED:])

    def _report(self, key: tuple[str, str, str], seen: _Seen) -> None:
        callback, exception, place = key
        more, seen.reported = seen.count - seen.reported, seen.count
        times = "once more" if more == 1 else f"{more} times more"
        text = f"{_words(callback)} raised {exception} {times} ({place}: {seen.message})"
        self._logger.error_again(text)


def _words(callback: str) -> str:
    return f"callback of {callback}" if callback.startswith("/") else callback


def place_of(error: BaseException, function: object) -> Place:
    """Return the place of an exception: the innermost one in the user's own code.

    If lcmtools raised it about the function, for example about its return value, the place is where
    the function begins.
    """
    tb = error.__traceback__
    frames = [(f.f_code.co_filename, n, f.f_code.co_name) for f, n in traceback.walk_tb(tb)]
    outside = [frame for frame in frames if not _is_lcmtools(frame[0])]
    own = [frame for frame in outside if not frame[0].startswith(_library_folders())]
    # if only packages are involved, the callback's frame: it may call other packages
    found = own[-1:] or outside[:1]
    if not found and (code := getattr(function, "__code__", None)):
        found = [(code.co_filename, code.co_firstlineno, code.co_name)]
    return (found or frames[-1:] or [("", 0, "")])[0]


def _users_part(error: BaseException) -> TracebackType | None:
    """Return an exception's traceback from the user's callback on."""
    tb = error.__traceback__
    while tb is not None and _is_lcmtools(tb.tb_frame.f_code.co_filename):
        tb = tb.tb_next
    return tb or error.__traceback__


@cache
def _is_lcmtools(file: str) -> bool:
    path = Path(file)
    return path.is_relative_to(_PACKAGE) and not path.is_relative_to(_PROGRAMS)


@cache
def _library_folders() -> tuple[str, ...]:
    import sysconfig  # slow to import, and seldom needed

    names = ("stdlib", "platstdlib", "purelib", "platlib")
    return ("<frozen", *(f"{sysconfig.get_path(name)}{os.sep}" for name in names))
