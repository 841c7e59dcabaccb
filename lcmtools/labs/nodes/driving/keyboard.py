"""The sources of keys: a terminal, or a script on standard input.

In a script, ``i 2 j 1.5 k`` is key i, 2 seconds, key j, 1.5 seconds, key k. Spaces may be left out
(``iik``), arrows are the words up, down, left and right, the space bar is space, and ``#`` begins a
comment. The meaning of keys is defined in ``motion``.
"""

import contextlib
import re
import sys
import time
from collections import deque
from collections.abc import Callable, Iterator
from typing import TypeAlias

from lcmtools.terminal import (
    DOWN,
    LEFT,
    RIGHT,
    UP,
    Terminal,
    TerminalKeys,
    is_readable,
    is_terminal,
    read_waiting,
    split_keys,
)

_NAMES = {**{name: name for name in (UP, DOWN, LEFT, RIGHT)}, "space": " "}
_WORDS = re.compile(
    r"(?P<skip>\s+|#[^\n]*)|(?<!\S)(?P<name>" + "|".join(_NAMES) + r")(?!\S)"
    r"|(?P<seconds>\d+(?:\.\d+)?|(?<!\S)\.\d+)|(?P<arrow>\x1b[\[O][A-D])|(?P<key>.)",
    re.DOTALL | re.ASCII,
)
# digits and comments at the end of a piece: more of them may follow
_UNFINISHED_WORD = re.compile(r"(\d+(\.\d*)?|(?<!\S)\.\d+|#[^\n]*)\Z", re.ASCII)
_LONGEST_WAIT = 1e6  # [s]


class KeyScript:
    """A script of keys that arrives in pieces and is played in time."""

    def __init__(self) -> None:
        self._steps: deque[str | float] = deque()
        self._rest = ""
        self._wait_until: float | None = None
        self._is_ended = False

    def feed(self, data: bytes, *, is_last: bool = False) -> None:
        """Add the next piece of the script."""
        text = self._rest + data.decode("utf-8", "replace")
        unfinished = None if is_last else _UNFINISHED_WORD.search(text)
        self._rest = unfinished.group() if unfinished else ""
        self._is_ended = is_last
        for match in _WORDS.finditer(text.removesuffix(self._rest)):
            if match["seconds"]:
                self._steps.append(min(float(match["seconds"]), _LONGEST_WAIT))
            elif match["arrow"]:
                self._steps.extend(split_keys(match["arrow"].encode(), is_complete=True)[0])
            elif not match["skip"]:
                self._steps.append(_NAMES.get(match.group(), match.group()))

    def due(self, now: float) -> list[str]:
        """Return the keys that are due by ``now`` [s], each once."""
        keys: list[str] = []
        while self._steps and not self._is_waiting(now):
            step = self._steps.popleft()
            if isinstance(step, float):
                # from when the wait before was over, so that waits add up exactly
                self._wait_until = (self._wait_until or now) + step
            else:
                keys.append(step)
        if not self._steps and not self._is_waiting(now):
            self._wait_until = None  # what comes later does not wait for the past
        return keys

    def is_over(self, now: float) -> bool:
        """Return True if all keys have been returned and all waits are over."""
        return self._is_ended and not self._steps and not self._is_waiting(now)

    def _is_waiting(self, now: float) -> bool:
        return self._wait_until is not None and now < self._wait_until


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
