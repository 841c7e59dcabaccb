"""Programs that are checked, whatever their language, and the results of a check.

A program runs on the test bench's bus and is certain to end; what it prints goes into a file, and
keys reach it through a terminal of its own.
"""

import shlex
import signal
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from shutil import which

from lcmtools.errors import UsageError
from lcmtools.processes.child import ChildProcess, Start, StopTimeouts
from lcmtools.processes.process_guard import ProcessGuard

_TIMEOUTS = StopTimeouts(4.0, 2.0)
_TAIL_BYTES = 65_536
_LONGEST_LINE = 200
_MOST_BYTES = 1 << 28  # of a file: a program that prints without end must not fill the disk


@dataclass(frozen=True, slots=True)
class CheckResult:
    """The result of checking one requirement.

    Attributes:
        what: The requirement, in a few words.
        wanted: The value that the lab specifies, with its unit.
        measured: The value that was measured, with its unit.
        is_ok: True if the requirement is met.
        hint: What to look at next if it is not.
    """

    what: str
    wanted: str
    measured: str
    is_ok: bool
    hint: str = ""


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
        words = [which(command[0], path=environment.get("PATH")) or command[0], *command[1:]]
        if command[0] == "lcmtools":  # the one that runs now, wherever it is installed
            words[:1] = [sys.executable, "-m", "lcmtools"]
        start = Start(
            words, environment, has_keyboard=has_keys, output=output, most_bytes=_MOST_BYTES
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

    def last_line(self) -> str:
        """Return the last line that it has printed, or ""."""
        lines = [line.strip() for line in self.printed().splitlines() if line.strip()]
        return lines[-1][:_LONGEST_LINE] if lines else ""

    def ends_on_interrupt(self) -> bool:
        """Press Ctrl-C; return True if it ends in time."""
        return self.interrupt(_TIMEOUTS.interrupt)

    def check_ctrl_c(self) -> CheckResult:
        """Check that Ctrl-C ends it; it has ended afterwards."""
        what = "ends on Ctrl-C"
        if self.code is not None:
            return self.early_end(what)
        ends = self.ends_on_interrupt()
        hint = "let the loop end when lcmtools.ok() is false, or catch KeyboardInterrupt"
        return CheckResult(what, "within 4 s", "it ends" if ends else "it goes on", ends, hint)

    def early_end(self, what: str, wanted: str = "it runs") -> CheckResult:
        """Return the failure of a program that has ended while it was needed."""
        code = self.code or 0
        how = (
            f"was ended by {signal.Signals(-code).name}"
            if code < 0
            else f"ended with exit code {code}"
        )
        line = self.last_line()
        hint = f"its last line: {line}" if line else "it printed nothing"
        return CheckResult(what, wanted, f"it {how}", is_ok=False, hint=hint)

    def nothing_within(self, seconds: float, what: str, wanted: str, hint: str) -> CheckResult:
        """Return the failure of a program from which nothing has come in time."""
        if self.code is not None:
            return self.early_end(what, wanted)
        return CheckResult(what, wanted, f"none within {seconds:g} s", is_ok=False, hint=hint)


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
