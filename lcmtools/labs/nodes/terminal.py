"""A terminal that hands over keys and pictures, and is surely given back as it was.

Whatever ends the program, Ctrl-Z too, the terminal's settings and its cursor are restored: when
the block ends, and once more when the process does. What is shown or typed is not known here.
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
from typing import Protocol, TextIO

ENDING_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)
"""What a person, a script, a closed terminal and Ctrl-\\ end a program with."""


class Stoppable(Protocol):
    """An object that a signal stops: a node's context."""

    def ok(self) -> bool:
        """Return whether nothing has stopped it yet."""
        ...

    def stop(self) -> None:
        """Ask everything that spins to return."""
        ...


@contextlib.contextmanager
def ended_by_signals(context: Stoppable) -> Iterator[None]:
    """Let every signal that ends a program stop the context, and nothing else.

    A second signal interrupts nothing: what a program does to end, as stopping its robot, is done
    in full. It takes a moment only.
    """

    def end(_number: int, _frame: FrameType | None) -> None:
        context.stop()

    before = {number: signal.signal(number, end) for number in ENDING_SIGNALS}
    try:
        yield
    finally:
        for number, handler in before.items():
            # a terminal that is closed is told twice, by the kernel and by the shell
            is_told_twice = number == signal.SIGHUP and not context.ok()
            signal.signal(number, signal.SIG_IGN if is_told_twice else handler)


class Terminal:
    """Standard input and error, or output, as a terminal with settings of one's own.

    Args:
        keys: Keys are handed over one by one and not shown; a terminal is at standard input.
        opening: What is written to set up the screen.
        closing: What undoes that.
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
            signal.SIGTSTP: signal.signal(signal.SIGTSTP, self._ask_to_suspend),
            signal.SIGCONT: signal.signal(signal.SIGCONT, self._note_resumption),
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

    def _apply(self) -> None:
        with contextlib.suppress(termios.error):  # gone already: reading it will tell
            if self._keys is not None:
                tty.setcbreak(self._keys, termios.TCSANOW)
                _never_halt_output(self._keys)
        self._write(self._opening)

    def _restore(self) -> None:
        self._write(self._closing)
        if self._keys is not None and self._saved is not None:
            with contextlib.suppress(termios.error):
                termios.tcsetattr(self._keys, termios.TCSANOW, self._saved)

    def obey(self) -> bool:
        """Suspend the program if Ctrl-Z was pressed; to be called some times a second.

        A signal's handler may not do it: it can interrupt a message or a line that is half sent.

        Returns:
            Whether the program was suspended: what is on the screen is no longer there.
        """
        if self._is_to_suspend:
            self._is_to_suspend = False
            self._suspend()
        is_resumed, self._is_resumed = self._is_resumed, False
        if is_resumed:
            self._apply()
        return is_resumed

    def _suspend(self) -> None:
        """Give the terminal back, and stop as if the signal had not been caught."""
        self._on_suspend()
        self._restore()
        handler = signal.signal(signal.SIGTSTP, signal.SIG_DFL)
        os.kill(os.getpid(), signal.SIGTSTP)
        signal.signal(signal.SIGTSTP, handler)  # here somebody has let it go on
        self._is_resumed = True

    def _ask_to_suspend(self, _number: int, _frame: FrameType | None) -> None:
        self._is_to_suspend = True

    def _note_resumption(self, _number: int, _frame: FrameType | None) -> None:
        self._is_resumed = True

    @staticmethod
    def _write(text: str) -> None:
        if not text:
            return
        with contextlib.suppress(OSError, ValueError):  # the terminal is closed
            sys.stdout.write(text)
            sys.stdout.flush()


def _never_halt_output(descriptor: int) -> None:
    """Make Ctrl-S a key like any other: who waits for output to go on drives no robot."""
    attributes = termios.tcgetattr(descriptor)
    attributes[0] &= ~termios.IXON
    termios.tcsetattr(descriptor, termios.TCSANOW, attributes)


def is_terminal(stream: TextIO) -> bool:
    """Return whether a stream is an open terminal."""
    try:
        return stream.isatty()
    except (OSError, ValueError):  # closed
        return False
