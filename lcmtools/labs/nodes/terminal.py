"""A terminal that hands over keys and pictures, and is restored.

Whatever ends the program, Ctrl-Z too, the terminal's settings and its cursor are restored: when
the block ends, and once more when the process does. The meaning of keys and text is not known here.
"""

import atexit
import contextlib
import os
import signal
import sys
import termios
import tty
from collections.abc import Callable, Iterator
from types import FrameType
from typing import TextIO

from lcmtools import Node

_ENDING_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)


@contextlib.contextmanager
def ended_by_signals(node: Node) -> Iterator[None]:
    """Let every signal that ends a program stop the node's context, and nothing else.

    A second signal interrupts nothing: what a program does to end, as stopping its robot, is done
    in full. It takes a moment only.
    """

    def end(_number: int, _frame: FrameType | None) -> None:
        node.context.stop()

    before = {number: signal.signal(number, end) for number in _ENDING_SIGNALS}
    try:
        yield
    finally:
        for number, handler in before.items():
            # the end of a terminal is reported twice, by the kernel and by the shell
            is_repeated = number == signal.SIGHUP and not node.context.ok()
            signal.signal(number, signal.SIG_IGN if is_repeated else handler)


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
        with contextlib.suppress(termios.error):  # gone already: reading it will show that
            if self._keys is not None:
                tty.setcbreak(self._keys, termios.TCSANOW)
                # Ctrl-S is a key like any other: a program that cannot write drives no robot
                attributes = termios.tcgetattr(self._keys)
                attributes[0] &= ~termios.IXON
                termios.tcsetattr(self._keys, termios.TCSANOW, attributes)
        _write(self._opening)

    def _restore(self) -> None:
        _write(self._closing)
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


def _write(text: str) -> None:
    if text:
        with contextlib.suppress(OSError, ValueError):  # the terminal is closed
            sys.stdout.write(text)
            sys.stdout.flush()


def is_terminal(stream: TextIO) -> bool:
    """Return whether a stream is an open terminal."""
    try:
        return stream.isatty()
    except (OSError, ValueError):  # closed
        return False
