"""Programs under check, in any language.

A program runs on the test bench's bus and always ends with it. Its output goes to a file, and keys
reach it through its own terminal.
"""

import errno
import os
import re
import shlex
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from shutil import which

from lcmtools.errors import UsageError
from lcmtools.packages.cpp_nodes import is_cpp
from lcmtools.processes.child import ChildProcess, Start, StopTimeouts
from lcmtools.processes.process_guard import ProcessGuard

_ESCAPE = re.compile(r"\x1b(?:\[[0-?]*[ -/]*[@-~]|[ -/]*[0-~])")  # as curses writes
_TIMEOUTS = StopTimeouts(4.0, 2.0)
_TAIL_BYTES = 65_536
_MOST_BYTES = 1 << 28  # of a file: a program that prints without end must not fill the disk


def check_startable(command: Sequence[str]) -> None:
    """Raise UsageError unless a command line's first word is a program, or a source in C++."""
    if command[0] != "lcmtools" and not is_cpp(Path(command[0])) and which(command[0]) is None:
        is_path = "/" in command[0] and Path(command[0]).exists()
        raise _cannot_run(command[0], os.strerror(errno.EACCES if is_path else errno.ENOENT))


def _cannot_run(program: str, reason: str | None) -> UsageError:
    hint = "give the command line as you type it, in quotes"
    return UsageError(f"cannot run '{program}': {reason}", hint)


class CheckedProgram(ChildProcess):
    """A process with its output in a file; ``guard`` ends it together with this process.

    With ``has_keys`` it has a terminal to read keys from.

    Raises:
        UsageError: It cannot be started.
    """

    def __init__(
        self,
        command: Sequence[str],
        environment: Mapping[str, str],
        output: Path,
        guard: ProcessGuard,
        *,
        has_keys: bool = False,
    ) -> None:
        self.was_interrupted = False
        self._has_keys = has_keys
        words = [which(command[0], path=environment.get("PATH")) or command[0], *command[1:]]
        if command[0] == "lcmtools":
            words[:1] = own_command()
        start = Start(
            words, environment, has_keyboard=has_keys, output=output, most_bytes=_MOST_BYTES
        )
        try:
            super().__init__(start, guard, _TIMEOUTS)
        except OSError as error:
            raise _cannot_run(command[0], error.strerror) from None

    def printed(self) -> str:
        """Return its output, or the end of it if it is long."""
        return _ESCAPE.sub("", self.output(_TAIL_BYTES))

    def ends_on_interrupt(self) -> bool:
        """Press Ctrl-C; return True if it ends in time."""
        if self._has_keys and not self.was_interrupted:
            self.press("\x03")
            if not self.wait(_TIMEOUTS.interrupt / 2) and self.takes_interrupts_as_keys():
                self.press("\x03")  # it may have thrown the first one away
        elif not self.was_interrupted:
            self.ask_to_end(0.0)
        self.was_interrupted = True
        return self.wait(_TIMEOUTS.interrupt)


def own_path() -> str:
    """Return where programs are searched: beside this Python first."""
    return os.pathsep.join((str(Path(sys.executable).parent), os.environ.get("PATH", "")))


def own_command() -> list[str]:
    """Return the command line of the lcmtools that runs now.

    The script is preferred: with -m, files in the working directory would be imported as modules.
    """
    script = Path(sys.executable).with_name("lcmtools")
    return [str(script)] if script.exists() else [sys.executable, "-m", "lcmtools"]


def split_command(text: str) -> list[str]:
    """Split a command line like a shell.

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
