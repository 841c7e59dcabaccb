"""The rows of a check's result, one a question, and those that every program's check can need."""

import signal
from dataclasses import dataclass

from lcmtools.labs.checks.programs import CheckedProgram


@dataclass(frozen=True, slots=True)
class Row:
    """One thing that was looked at.

    Attributes:
        what: In a few words.
        wanted: What the lab asks for, with its unit.
        measured: What was seen, with its unit.
        is_ok: Whether the one is as good as the other.
        hint: What to look at next; "" where all is well.
    """

    what: str
    wanted: str
    measured: str
    is_ok: bool
    hint: str = ""


def row(what: str, wanted: str, measured: str, *, is_ok: bool, hint: str) -> Row:
    """A row whose hint counts only where something is wrong."""
    return Row(what, wanted, measured, is_ok, "" if is_ok else hint)


def fate(what: str, program: CheckedProgram, wanted: str = "it runs") -> Row:
    """A row about a program that ended where it should have gone on."""
    code = program.code
    if code is None:
        ending = "it runs"
    elif code < 0:
        ending = f"it was ended by {signal.Signals(-code).name}"
    else:
        ending = f"it ended with exit code {code}"
    words = program.last_words()
    hint = f"it said: {words}" if words else "it said nothing"
    return Row(what, wanted, ending, is_ok=False, hint=hint)


def ends_on_ctrl_c(program: CheckedProgram) -> Row:
    """A row about whether Ctrl-C ends it; it has ended afterwards."""
    runs = program.code is None
    if not runs:
        return fate("ends on Ctrl-C", program)
    ends = program.ends_on_interrupt()
    return row(
        "ends on Ctrl-C",
        "within 4 s",
        "it ends" if ends else "it goes on",
        is_ok=ends,
        hint="let the loop end when lcmtools.ok() is false, or catch KeyboardInterrupt",
    )
