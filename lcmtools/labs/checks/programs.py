"""Programs that are checked: started on the stage's bus, watched, and certain to end.

A program may be anything that can be started; what it prints goes into a file, and keys reach it
through a terminal of its own.
"""

import shlex
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from shutil import which

from lcmtools.errors import UsageError
from lcmtools.processes.child import ChildProcess, Start, StopTimeouts
from lcmtools.processes.process_guard import ProcessGuard

_TIMEOUTS = StopTimeouts(4.0, 2.0)
_TAIL_BYTES = 65_536
_LONGEST_LINE = 200
_MOST_BYTES = 1 << 28  # of a file: a program that prints without end must not fill the disk


def split_command(text: str) -> list[str]:
    """Return the words of a command line, split as a shell does.

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


class CheckedProgram(ChildProcess):
    """A program whose output goes into a file.

    Args:
        command: Its words.
        environment: Its variables.
        output: The file for what it prints.
        guard: Ends it with this process.
        has_keys: Give it a terminal to read keys from.

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
        start = Start(
            _found(command, environment),
            environment,
            has_keyboard=has_keys,
            output=output,
            most_bytes=_MOST_BYTES,
        )
        try:
            super().__init__(start, guard, _TIMEOUTS)
        except OSError as error:
            hint = "give the command line as you type it, in quotes"
            if Path(command[0]).suffix == ".py" and Path(command[0]).is_file():
                hint = f'did you mean "python {command[0]}"?'
            raise UsageError(f"cannot run '{command[0]}': {error.strerror}", hint) from None

    def printed(self) -> str:
        """Return what it has printed, the end of it where it is long."""
        return self.output(_TAIL_BYTES)

    def last_words(self) -> str:
        """Return the last line that it has printed, or ""."""
        lines = [line.strip() for line in self.printed().splitlines() if line.strip()]
        return lines[-1][:_LONGEST_LINE] if lines else ""

    def ends_on_interrupt(self) -> bool:
        """Press Ctrl-C; return True if it ends in time."""
        return self.interrupt(_TIMEOUTS.interrupt)


def _found(command: Sequence[str], environment: Mapping[str, str]) -> list[str]:
    """Return the command, with the lcmtools that runs now, wherever it is installed."""
    if command[0] == "lcmtools":
        return [sys.executable, "-m", "lcmtools", *command[1:]]
    return [which(command[0], path=environment.get("PATH")) or command[0], *command[1:]]
