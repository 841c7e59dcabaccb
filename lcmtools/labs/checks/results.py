"""The results of checks: rows, causes, and the report of a program, as plain values."""

from collections.abc import Sequence
from dataclasses import dataclass

from lcmtools.labs.checks.observations import Observations


@dataclass(frozen=True, slots=True)
class Cause:
    """The cause of a failure, with its remedy. Rows with the same key have the same cause."""

    key: str
    text: str


@dataclass(frozen=True, slots=True)
class CheckResult:
    """The result of checking one requirement."""

    what: str  # the requirement, in a few words
    wanted: str  # the value that the lab specifies, with its unit
    measured: str  # the value that was measured, with its unit
    is_ok: bool  # True if the requirement is met
    hint: str = ""  # the cause if it is not, or what to look at next
    cause: str = ""  # the key of the cause; rows of the same cause have the same
    follows: str = ""  # the row whose cause is the cause of this one; "" for none
    said: str = ""  # the program's own last words, beside the first row of a cause
    findings: tuple[str, ...] = ()  # what wtf finds of the program on the check's own bus


@dataclass(frozen=True, slots=True)
class Report:
    """The results of one program."""

    program: str  # its option on the command line ("controller")
    command: Sequence[str]  # its command line
    results: Sequence[CheckResult]  # its rows
    observations: Observations | None = None  # what was observed of it; None if it could not be run
    is_answer: bool = False  # it is the model answer of lcmtools
    # The time that the check takes where the simulation keeps its pace, without the simulator's
    # start [s].
    duration: float = 0.0

    @property
    def passed(self) -> int:
        """The number of passed rows."""
        return sum(result.is_ok for result in self.results)

    @property
    def first_cause(self) -> str:
        """The cause of the first failed row; "" if all passed."""
        return next((r.hint or r.measured for r in self.results if not r.is_ok), "")


def as_specified(reports: Sequence[Report]) -> bool:
    """Return True if there are rows and all passed."""
    return bool(reports) and all(r.results and r.passed == len(r.results) for r in reports)
