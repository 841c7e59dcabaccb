"""A terminal that hands over keys and pictures, and is restored.

Whatever ends the program, Ctrl-Z too, the terminal's settings and its cursor are restored: when
the block ends, and once more when the process does. The meaning of keys and text is not known here.
"""

import atexit
import contextlib
import os
import re
import select
import signal
import sys
import termios
import time
import tty
from collections.abc import Callable, Iterator, Sequence
from types import FrameType
from typing import TextIO

_ESCAPE_TIME = 0.05
"""Seconds within which a terminal sends the rest of an arrow's sequence, over a network too."""
_AT_ONCE = 4096

UP, DOWN, LEFT, RIGHT = "up", "down", "left", "right"
ESCAPE = "escape"
END_OF_INPUT = "end"
"""Ctrl-D, which a terminal that hands over single keys passes on as a character."""

_ARROWS = {"A": UP, "B": DOWN, "C": RIGHT, "D": LEFT}
_CONTROLS = {"\x04": END_OF_INPUT, "\x1b": ESCAPE}
# ECMA-48: ESC [ parameters, intermediates, a final character; ESC O and a letter is what keypads
# send (xterm, Control Sequences, "SS3"); ESC [ M and three bytes is an old kind of mouse report.
_SEQUENCE = re.compile(
    r"\x1b\[M...|\x1b\[[0-?]*[ -/]*(?P<last>[@-~])|\x1bO(?P<pad>.)|\x1b(?P<alt>[^\x1b\[O])|.",
    re.DOTALL,
)
_UNFINISHED = re.compile(r"\x1b(\[M.{0,2}|\[[0-?]*[ -/]*|O)?\Z", re.DOTALL)


def split_keys(data: bytes, *, is_complete: bool) -> tuple[list[str], bytes]:
    """Return the keys in the bytes of a terminal: characters, and the names above.

    Escape sequences other than the arrows' (function keys, mouse, focus) are left out; what is
    typed with Alt counts as the character alone.

    Args:
        data: The bytes so far.
        is_complete: No more belongs to them: an escape character at the end is the Escape key.

    Returns:
        The keys, and the bytes of the beginning of another one.
    """
    text = data.decode("utf-8", "surrogateescape")
    unfinished = None if is_complete else _UNFINISHED.search(text)
    rest = unfinished.group() if unfinished else ""
    found = (_key(match) for match in _SEQUENCE.finditer(text.removesuffix(rest)))
    return [key for key in found if key], rest.encode("utf-8", "surrogateescape")


def _key(match: re.Match[str]) -> str:
    """Return a key's name; "" for a sequence that is none."""
    text = match.group()
    if len(text) == 1:
        return _CONTROLS.get(text, text)
    if match["alt"]:
        return match["alt"]
    return _ARROWS.get(match["last"] or match["pad"] or "", "")


class Terminal:
    """Standard input and error, or output, as a terminal with settings of one's own.

    Args:
        keys: Keys are handed over one by one and not shown; a terminal is at standard input.
        opening: The text that sets up the screen.
        closing: The text that undoes that.
        on_suspend: Called before Ctrl-Z stops the program.
    """

    def __init__(
        self,
        *,
        keys: bool,
        opening: str = "",
        closing: str = "",
        on_suspend: Callable[[], object] = lambda: None,
    ) -> None:
        self._keys = sys.stdin.fileno() if keys else None
        self._opening, self._closing = opening, closing
        self._on_suspend = on_suspend
        self._is_to_suspend = self._is_resumed = False
        self._saved: list[int | list[bytes | int]] | None = None
        self._handlers: dict[int, Callable[[int, FrameType | None], object] | int | None] = {}

    def __enter__(self) -> "Terminal":
        """Set it up."""
        if self._keys is not None:
            with contextlib.suppress(termios.error):  # gone already: reading it will show that
                self._saved = termios.tcgetattr(self._keys)
        self._handlers = {
            signal.SIGTSTP: signal.signal(signal.SIGTSTP, self._take_suspension),
            signal.SIGCONT: signal.signal(signal.SIGCONT, self._take_resumption),
        }
        atexit.register(self._restore)
        self._apply()
        return self

    def __exit__(self, *_: object) -> None:
        """Give it back."""
        for number, handler in self._handlers.items():
            signal.signal(number, handler)
        self._restore()
        atexit.unregister(self._restore)

    def obey(self) -> bool:
        """Suspend the program if Ctrl-Z was pressed; to be called some times a second.

        A signal's handler may not do it: it can interrupt a message or a line that is half sent.

        Returns:
            True if the program was suspended: what was on the screen is no longer there.
        """
        if self._is_to_suspend:
            self._is_to_suspend = False
            self._suspend()
        is_resumed, self._is_resumed = self._is_resumed, False
        if is_resumed:
            self._apply()
        return is_resumed

    def _apply(self) -> None:
        with contextlib.suppress(termios.error):
            if self._keys is not None:
                tty.setcbreak(self._keys, termios.TCSANOW)
                # Ctrl-S is a key like any other: a program that cannot write drives no robot
                attributes = termios.tcgetattr(self._keys)
                attributes[0] &= ~termios.IXON
                termios.tcsetattr(self._keys, termios.TCSANOW, attributes)
        write_screen(self._opening)

    def _restore(self) -> None:
        write_screen(self._closing)
        if self._keys is not None and self._saved is not None:
            with contextlib.suppress(termios.error):
                termios.tcsetattr(self._keys, termios.TCSANOW, self._saved)

    def _suspend(self) -> None:
        """Give the terminal back, and stop as if the signal had not been caught."""
        self._on_suspend()
        self._restore()
        handler = signal.signal(signal.SIGTSTP, signal.SIG_DFL)
        os.kill(os.getpid(), signal.SIGTSTP)
        signal.signal(signal.SIGTSTP, handler)  # here the program goes on
        self._is_resumed = True

    def _take_suspension(self, _number: int, _frame: FrameType | None) -> None:
        self._is_to_suspend = True

    def _take_resumption(self, _number: int, _frame: FrameType | None) -> None:
        self._is_resumed = True


class TerminalKeys:
    """The keys that are pressed at standard input's terminal, which hands over single ones."""

    def __init__(self, terminal: Terminal) -> None:
        self.is_over = False
        self._terminal = terminal
        self._rest = b""

    def read(self, seconds: float) -> list[str]:
        """Return the keys that have come."""
        self._terminal.obey()
        if not is_readable(_ESCAPE_TIME if self._rest else seconds):
            keys, self._rest = split_keys(self._rest, is_complete=True)
            return keys
        data = read_waiting()
        self.is_over = not data
        keys, self._rest = split_keys(self._rest + data, is_complete=self.is_over)
        if END_OF_INPUT in keys:
            self.is_over = True
            keys = keys[: keys.index(END_OF_INPUT)]
        return keys


def write_screen(text: str, stream: TextIO | None = None) -> None:
    """Write to a terminal, that of standard output if no other is given, if it is still there."""
    stream = stream or sys.stdout
    with contextlib.suppress(OSError, ValueError):  # the terminal is closed
        stream.write(text)
        stream.flush()


def is_terminal(stream: TextIO) -> bool:
    """Return whether a stream is an open terminal."""
    try:
        return stream.isatty()
    except (OSError, ValueError):  # closed
        return False


@contextlib.contextmanager
def open_keys(
    on_suspend: Callable[[], object],
) -> Iterator[Callable[[float], Sequence[str]]]:
    """Yield a function that waits so many seconds at most, and returns the keys that came.

    They are those of the terminal at standard input. Where there is none, or the program runs in
    its background, no key ever comes.
    """
    if not has_keys():
        yield _no_keys
        return
    with Terminal(keys=True, on_suspend=on_suspend) as terminal:
        keys = TerminalKeys(terminal)

        def wait(seconds: float) -> Sequence[str]:
            return _no_keys(seconds) if keys.is_over else keys.read(seconds)

        yield wait


def has_keys() -> bool:
    """Return whether keys of a terminal at standard input come to this program."""
    if not is_terminal(sys.stdin):
        return False
    try:
        return os.tcgetpgrp(sys.stdin.fileno()) == os.getpgrp()
    except OSError:  # it is not the terminal that controls this program, which has no background
        return True


def _no_keys(seconds: float) -> Sequence[str]:
    time.sleep(seconds)
    return ()


def is_readable(seconds: float) -> bool:
    """Return whether standard input has something, or has ended; wait for it at most so long."""
    return bool(select.select([sys.stdin.fileno()], [], [], seconds)[0])


def read_waiting() -> bytes:
    """Return what has come on standard input; empty at the end, and where the terminal is gone."""
    # not sys.stdin.read(): what waits in its buffer is hidden from select
    try:
        return os.read(sys.stdin.fileno(), _AT_ONCE)
    except OSError:
        return b""
