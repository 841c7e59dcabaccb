"""Reading keys from a terminal, and restoring its settings afterwards.

The terminal's settings and its cursor are restored when the block ends, again when the process
ends, and while Ctrl-Z suspends it. Must not know the meaning of keys and text.
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
"""Seconds within which the rest of an arrow key's sequence arrives, also over a network."""
_AT_ONCE = 4096

UP, DOWN, LEFT, RIGHT = "up", "down", "left", "right"
ESCAPE = "escape"
END_OF_INPUT = "end"
"""Ctrl-D, which a terminal that passes on single keys sends as a character."""

_ARROWS = {"A": UP, "B": DOWN, "C": RIGHT, "D": LEFT}
_CONTROLS = {"\x04": END_OF_INPUT, "\x1b": ESCAPE}
# ECMA-48: ESC [ parameters, intermediates, a final character. Keypads send ESC O and a letter
# (xterm, Control Sequences, "SS3"); ESC [ M and three bytes is an old form of mouse report.
_SEQUENCE = re.compile(
    r"\x1b\[M...|\x1b\[[0-?]*[ -/]*(?P<last>[@-~])|\x1bO(?P<pad>.)|\x1b(?P<alt>[^\x1b\[O])|.",
    re.DOTALL,
)
_UNFINISHED = re.compile(r"\x1b(\[M.{0,2}|\[[0-?]*[ -/]*|O)?\Z", re.DOTALL)


def split_keys(data: bytes, *, is_complete: bool) -> tuple[list[str], bytes]:
    """Split the bytes from a terminal into keys: characters, and names such as ``UP``.

    Escape sequences other than arrow keys (function keys, mouse, focus) are left out. A key typed
    with Alt counts as the key alone.

    Args:
        data: The bytes so far.
        is_complete: No more bytes follow: an escape character at the end is the Escape key.

    Returns:
        The keys, and the bytes of an incomplete sequence at the end.
    """
    text = data.decode("utf-8", "surrogateescape")
    unfinished = None if is_complete else _UNFINISHED.search(text)
    rest = unfinished.group() if unfinished else ""
    found = (_key(match) for match in _SEQUENCE.finditer(text.removesuffix(rest)))
    return [key for key in found if key], rest.encode("utf-8", "surrogateescape")


def _key(match: re.Match[str]) -> str:
    """Return a key's name; "" for a sequence that is not a key."""
    text = match.group()
    if len(text) == 1:
        return _CONTROLS.get(text, text)
    if match["alt"]:
        return match["alt"]
    return _ARROWS.get(match["last"] or match["pad"] or "", "")


class Terminal:
    """The terminal at standard input and output, with its own settings within a block.

    Args:
        keys: Read single keys without echo; standard input must be a terminal.
        opening: The text that sets up the screen.
        closing: The text that restores the screen.
        on_suspend: Called before Ctrl-Z suspends the program.
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
        """Set up the terminal."""
        if self._keys is not None:
            with contextlib.suppress(termios.error):  # closed already: reading will show it
                self._saved = termios.tcgetattr(self._keys)
        self._handlers = {
            signal.SIGTSTP: signal.signal(signal.SIGTSTP, self._request_suspension),
            signal.SIGCONT: signal.signal(signal.SIGCONT, self._note_resumption),
        }
        atexit.register(self._restore)
        self._apply()
        return self

    def __exit__(self, *_: object) -> None:
        """Restore the terminal."""
        for number, handler in self._handlers.items():
            signal.signal(number, handler)
        self._restore()
        atexit.unregister(self._restore)

    def obey(self) -> bool:
        """Suspend the program if Ctrl-Z was pressed; call it several times a second.

        The signal's handler does not suspend: it could interrupt a half-sent message or line.

        Returns:
            True if the program was suspended: the screen's content is lost.
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
                # Ctrl-S is an ordinary key: a program that it stops could not stop a robot
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
        """Restore the terminal, and stop as if the signal had not been caught."""
        self._on_suspend()
        self._restore()
        handler = signal.signal(signal.SIGTSTP, signal.SIG_DFL)
        os.kill(os.getpid(), signal.SIGTSTP)
        signal.signal(signal.SIGTSTP, handler)  # the program continues here
        self._is_resumed = True

    def _request_suspension(self, _number: int, _frame: FrameType | None) -> None:
        self._is_to_suspend = True

    def _note_resumption(self, _number: int, _frame: FrameType | None) -> None:
        self._is_resumed = True


class TerminalKeys:
    """The keys pressed at a terminal that passes on single keys."""

    def __init__(self, terminal: Terminal) -> None:
        self.is_over = False
        self._terminal = terminal
        self._rest = b""

    def read(self, seconds: float) -> list[str]:
        """Wait for keys and return them."""
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
    """Write to a terminal, by default standard output; ignore a closed one."""
    stream = stream or sys.stdout
    with contextlib.suppress(OSError, ValueError):  # the terminal is closed
        stream.write(text)
        stream.flush()


def is_terminal(stream: TextIO) -> bool:
    """Return True for a stream that is an open terminal."""
    try:
        return stream.isatty()
    except (OSError, ValueError):  # closed
        return False


@contextlib.contextmanager
def open_keys(
    on_suspend: Callable[[], object],
) -> Iterator[Callable[[float], Sequence[str]]]:
    """Yield a function that waits up to the given seconds for keys and returns them.

    It never returns a key if standard input is not a terminal or the program runs in the
    background.
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
    """Return True if this program receives the keys of a terminal at standard input."""
    if not is_terminal(sys.stdin):
        return False
    try:
        return os.tcgetpgrp(sys.stdin.fileno()) == os.getpgrp()
    except OSError:  # not this program's controlling terminal: it cannot be in its background
        return True


def _no_keys(seconds: float) -> Sequence[str]:
    time.sleep(seconds)
    return ()


def is_readable(seconds: float) -> bool:
    """Wait up to the given seconds; return True if standard input has data or has ended."""
    return bool(select.select([sys.stdin.fileno()], [], [], seconds)[0])


def read_waiting() -> bytes:
    """Read the available standard input; empty at its end or if the terminal is closed."""
    # not sys.stdin.read(), whose buffer is hidden from select
    try:
        return os.read(sys.stdin.fileno(), _AT_ONCE)
    except OSError:
        return b""
