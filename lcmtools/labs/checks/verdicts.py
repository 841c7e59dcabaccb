"""Rows that every program's check can need: how it ended, and whether it can be ended."""

import signal

from lcmtools.labs.checks.programs import CheckedProgram
from lcmtools.labs.checks.row import Row, row


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
