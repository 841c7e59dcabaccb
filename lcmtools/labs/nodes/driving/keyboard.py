"""The sources of keys: a terminal, or a script on standard input.

Their meaning is defined in ``motion``.
"""

import contextlib
import sys
import time
from collections.abc import Callable, Iterator
from typing import TypeAlias

from lcmtools.labs.nodes.driving.key_script import KeyScript
from lcmtools.terminal import Terminal, TerminalKeys, is_readable, is_terminal, read_waiting


@contextlib.contextmanager
def open_keyboard(on_suspend: Callable[[], object]) -> "Iterator[Keyboard]":
    """Yield the keys of standard input: a terminal's, or those of a piped script."""
    if not is_terminal(sys.stdin):
        yield PipedKeys()
        return
    with Terminal(keys=True, on_suspend=on_suspend) as terminal:
        yield TerminalKeys(terminal)


class PipedKeys:
    """The keys of a piped script, when they are due."""

    def __init__(self) -> None:
        self.is_over = False
        self._script = KeyScript()
        self._has_ended = False

    def read(self, seconds: float) -> list[str]:
        """Return the keys that have come, after waiting ``seconds`` at most for the first."""
        if self._has_ended:
            time.sleep(0 if self._script.is_over(time.monotonic()) else seconds)
        elif is_readable(seconds):
            data = read_waiting()
            self._has_ended = not data
            self._script.feed(data, is_last=not data)
        now = time.monotonic()
        keys = self._script.due(now)
        self.is_over = self._script.is_over(now)
        return keys


Keyboard: TypeAlias = TerminalKeys | PipedKeys
"""A source of keys; no more will come once it ``is_over``."""
