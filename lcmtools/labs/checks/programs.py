"""Programs that are checked: started on the stage's bus, listened to, and surely ended.

A program may be anything that can be started; what it prints goes into a file, and keys reach it
by a terminal of its own.
"""

import contextlib
import fcntl
import os
import pty
import resource
import shlex
import signal
import subprocess
import sys
import termios
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from lcmtools.errors import UsageError

_INTERRUPT, _TERMINATE = 4.0, 2.0
_TURN = 0.02
_TAIL_BYTES = 65_536
_LONGEST_LINE = 200
_MOST_BYTES = 1 << 28  # of a file: a program that prints without end must not fill the disk


def split_command(text: str) -> list[str]:
    """The words of a command line, as a shell would take them.

    Raises:
        UsageError: It is empty, or a quotation mark is missing.
    """
    try:
        words = shlex.split(text)
    except ValueError:
        raise UsageError(f"a quotation mark is missing in: {text}") from None
    if not words:
        raise UsageError("the command line is empty", 'for example "python my_controller.py"')
    return words


class Program:
    """A process, in a group of its own.

    Args:
        command: Its words.
        environment: Its variables.
        output: The file for what it prints.
        bind: Called in the new process before it becomes the program.
        has_keys: Give it a terminal to read keys from.

    Raises:
        UsageError: It cannot be started.
    """

    def __init__(
        self,
        command: Sequence[str],
        environment: Mapping[str, str],
        output: Path,
        bind: Callable[[], None],
        *,
        has_keys: bool = False,
    ) -> None:
        self._output = output
        self._keyboard: int | None = None
        terminal: int | None = None
        if has_keys:
            self._keyboard, terminal = pty.openpty()

        def prepare() -> None:
            if terminal is not None:
                fcntl.ioctl(0, termios.TIOCSCTTY, 0)
            resource.setrlimit(resource.RLIMIT_FSIZE, (_MOST_BYTES, _MOST_BYTES))
            bind()

        try:
            with output.open("wb") as stream:
                self._process = subprocess.Popen(  # noqa: S603 - what the user wants checked
                    _found(command, environment),
                    env=dict(environment),
                    stdin=subprocess.DEVNULL if terminal is None else terminal,
                    stdout=stream,
                    stderr=subprocess.STDOUT,
                    start_new_session=True,
                    preexec_fn=prepare,  # noqa: PLW1509 - it makes a few calls of the system
                )
        except OSError as error:
            self._close_keyboard()
            hint = "give the command line as you type it, in quotes"
            if Path(command[0]).suffix == ".py" and Path(command[0]).is_file():
                hint = f'did you mean "python {command[0]}"?'
            raise UsageError(f"cannot run '{command[0]}': {error.strerror}", hint) from None
        finally:
            if terminal is not None:
                os.close(terminal)
        self.pid = self._process.pid

    def __enter__(self) -> "Program":
        """It runs."""
        return self

    def __exit__(self, *_: object) -> None:
        """End it."""
        self.end()

    def press(self, key: str) -> None:
        """Press a key on its terminal."""
        assert self._keyboard is not None
        with contextlib.suppress(OSError):  # it is gone, which the caller sees
            os.write(self._keyboard, key.encode())

    def code(self) -> int | None:
        """Its exit code; negative for a signal; None while it runs."""
        return self._process.poll()

    def output(self) -> str:
        """What it has printed, the end of it where it is long."""
        with self._output.open("rb") as stream:
            size = stream.seek(0, os.SEEK_END)
            stream.seek(max(0, size - _TAIL_BYTES))
            return stream.read(_TAIL_BYTES).decode(errors="replace")

    def last_words(self) -> str:
        """The last line that it has printed, or ""."""
        lines = [line.strip() for line in self.output().splitlines() if line.strip()]
        return lines[-1][:_LONGEST_LINE] if lines else ""

    def interrupt(self, patience: float = _INTERRUPT) -> bool:
        """Press Ctrl-C; whether it has ended within so many seconds."""
        self._send(signal.SIGINT)
        return self._ends_within(patience)

    def end(self) -> None:
        """End it and all that it has started: SIGINT, SIGTERM, SIGKILL."""
        steps = ((signal.SIGINT, _INTERRUPT), (signal.SIGTERM, _TERMINATE), (signal.SIGKILL, 10.0))
        for number, patience in steps:
            if self.code() is None or number == signal.SIGKILL:
                self._send(number)
                self._ends_within(patience)
        self._close_keyboard()

    def _send(self, number: signal.Signals) -> None:
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, number)

    def _ends_within(self, patience: float) -> bool:
        deadline = time.monotonic() + patience
        while self.code() is None and time.monotonic() < deadline:
            time.sleep(_TURN)
        return self.code() is not None

    def _close_keyboard(self) -> None:
        if self._keyboard is not None:
            os.close(self._keyboard)
            self._keyboard = None


def _found(command: Sequence[str], environment: Mapping[str, str]) -> list[str]:
    """The command, with lcmtools being the one that runs, wherever it is installed."""
    if command[0] == "lcmtools":
        return [sys.executable, "-m", "lcmtools", *command[1:]]
    from shutil import which

    return [which(command[0], path=environment.get("PATH")) or command[0], *command[1:]]
