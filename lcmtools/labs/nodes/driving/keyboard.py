"""The sources of keys: a terminal, or a script on standard input.

What they mean is not known here.
"""

import contextlib
import os
import select
import sys
import time
from collections.abc import Callable, Iterator
from typing import Protocol

from lcmtools.labs.nodes.driving.keys import END_OF_INPUT, KeyScript, split_keys
from lcmtools.labs.nodes.terminal import Terminal, is_terminal

_ESCAPE_TIME = 0.05
"""Seconds within which a terminal sends the rest of an arrow's sequence, over a network too."""
_AT_ONCE = 4096


class Keyboard(Protocol):
    """A source of keys; no more will come once it is over."""

    is_over: bool

    def read(self, seconds: float) -> list[str]:
        """Return the keys that have come; wait for the first one at most so long."""
        ...


@contextlib.contextmanager
def open_keyboard(on_suspend: Callable[[], object]) -> Iterator[Keyboard]:
    """Yield the keyboard of standard input's terminal, or the script that is piped in."""
    if not is_terminal(sys.stdin):
        yield PipedKeys()
        return
    with Terminal(keys=True, on_suspend=on_suspend) as terminal:
        yield TerminalKeys(terminal)


class TerminalKeys:
    """The keys that are pressed at standard input's terminal, which hands over single ones."""

    def __init__(self, terminal: Terminal) -> None:
        self.is_over = False
        self._terminal = terminal
        self._rest = b""

    def read(self, seconds: float) -> list[str]:
        """Return the keys that have come."""
        self._terminal.obey()
        if not _is_readable(_ESCAPE_TIME if self._rest else seconds):
            keys, self._rest = split_keys(self._rest, is_complete=True)
            return keys
        data = _read()
        self.is_over = not data
        keys, self._rest = split_keys(self._rest + data, is_complete=self.is_over)
        if END_OF_INPUT in keys:
            self.is_over = True
            keys = keys[: keys.index(END_OF_INPUT)]
        return keys


class PipedKeys:
    """Keys by a script, in its time."""

    def __init__(self) -> None:
        self.is_over = False
        self._script = KeyScript()
        self._has_ended = False

    def read(self, seconds: float) -> list[str]:
        """Return the keys that have come."""
        if self._has_ended:
            time.sleep(0 if self._script.is_over(time.monotonic()) else seconds)
        elif _is_readable(seconds):
            data = _read()
            self._has_ended = not data
            self._script.feed(data, is_last=not data)
        now = time.monotonic()
        keys = self._script.due(now)
        self.is_over = self._script.is_over(now)
        return keys


def _is_readable(seconds: float) -> bool:
    return bool(select.select([sys.stdin.fileno()], [], [], seconds)[0])


def _read() -> bytes:
    """Return the input that has come; empty at the end, and where the terminal is gone."""
    # not sys.stdin.read(): what waits in its buffer is hidden from select
    try:
        return os.read(sys.stdin.fileno(), _AT_ONCE)
    except OSError:
        return b""
