"""The results of checks: rows, causes, and the report of a program, as plain values."""

from collections.abc import Sequence
from dataclasses import dataclass

from lcmtools.labs.checks.observations import Observations


@dataclass(frozen=True, slots=True)
class Cause:
    """The cause of a fault: rows of the same key have the same cause. The text names the remedy."""

    key: str
    text: str


@dataclass(frozen=True, slots=True)
class CheckResult:
    """The result of checking one requirement.

    Attributes:
        what: The requirement, in a few words.
        wanted: The value that the lab specifies, with its unit.
        measured: The value that was measured, with its unit.
        is_ok: True if the requirement is met.
        hint: The cause if it is not, or what to look at next.
        cause: The key of the cause; rows of the same cause have the same.
        follows: The row whose cause is the cause of this one; "" for none.
        said: The program's own last words, beside the first row of a cause.
        findings: What wtf finds of the program on the check's own bus.
    """

    what: str
    wanted: str
    measured: str
    is_ok: bool
    hint: str = ""
    cause: str = ""
    follows: str = ""
    said: str = ""
    findings: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Report:
    """The results of one program.

    Attributes:
        program: Its option on the command line ("controller").
        command: Its command line.
        results: Its rows.
        observations: What was observed of it; None if it could not be run.
        is_answer: It is the model answer of lcmtools.
        duration: The time that the check takes where the simulation keeps its pace, without the
            simulator's start [s].
    """

    program: str
    command: Sequence[str]
    results: Sequence[CheckResult]
    observations: Observations | None = None
    is_answer: bool = False
    duration: float = 0.0

    @property
    def passed(self) -> int:
        """The number of rows that are as specified."""
        return sum(result.is_ok for result in self.results)

    @property
    def first_cause(self) -> str:
        """The cause of the first row that is not ok; "" for none."""
        return next((r.hint or r.measured for r in self.results if not r.is_ok), "")


def as_specified(reports: Sequence[Report]) -> bool:
    """Return True if all rows are ok, and there are any."""
    return bool(reports) and all(r.results and r.passed == len(r.results) for r in reports)
