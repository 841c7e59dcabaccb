"""The rows that the programs of all labs have: a first result, the last command, the end.

The test bench runs a program, and these functions judge it.
"""

import time
from collections.abc import Callable
from dataclasses import replace

from lcmtools.labs.checks.checked_programs import CheckedProgram
from lcmtools.labs.checks.diagnosis import DIED, LASTING, SILENT, cause_of, velocity_of
from lcmtools.labs.checks.measures import velocity_text
from lcmtools.labs.checks.results import Cause, CheckResult
from lcmtools.labs.checks.test_bench import AFTER_END, TestBench

STOPS = "stops at the end"  # the row of a last command
_FIRST_MESSAGE = 10.0  # [s] from a program's start
_EARLY = 3.0  # [s] after which a program that is silent is looked at
_MOMENT = 0.05  # [s]


def first_command(bench: TestBench, hint: str) -> CheckResult:
    """Wait for the program's first command; return its row, with a hint if none comes."""
    row = CheckResult("commands the robot", "messages that come", "they come", is_ok=True)
    return first(bench, lambda: bench.recorder.commands, _FIRST_MESSAGE, replace(row, hint=hint))


def first(
    bench: TestBench, has_come: Callable[[], object], patience: float, row: CheckResult
) -> CheckResult:
    """Wait for the program's first result; return ``row``, or the row of a failure.

    The wait takes ``patience`` [s] at most, and is shorter if a cause of failure is certain.
    ``row`` has the hint for the failure.
    """
    program, start = bench.running(), time.monotonic()

    def is_over() -> bool:
        return bool(has_come()) or program.code is not None

    def failure() -> CheckResult:
        seconds = round(time.monotonic() - start)
        return nothing_within(program, seconds, row.what, row.wanted, row.hint)

    if not bench.wait(is_over, min(_EARLY, patience)) and patience > _EARLY:
        if cause_of(failure(), bench.observe()).key in LASTING:
            patience = 0.0
        else:
            bench.look_again()  # a later look shows more
        bench.wait(is_over, max(_MOMENT, start + patience - time.monotonic()))
    return row if has_come() else failure()


def stop_at_end(bench: TestBench) -> CheckResult:
    """End the program by Ctrl-C if it runs; return the row for its last command, a Twist."""
    program, commands = bench.running(), bench.recorder.commands
    ends = program.code is not None or program.ends_on_interrupt()
    stops = bench.wait(lambda: not any(velocity_of(commands[-1].message) or ()), AFTER_END)
    last = velocity_of(commands[-1].message) or (0.0, 0.0)
    measured = "it comes" if stops else velocity_text(last)
    text = "publish a final Twist of 0, also at Ctrl-C: the robot keeps its last command"
    cause = Cause("no-stop", text) if ends else why_it_goes_on(program)
    return CheckResult(STOPS, "a final Twist of 0", measured, stops, cause.text, cause.key)


def ends_on_ctrl_c(program: CheckedProgram, *, may_have_ended: bool = False) -> CheckResult:
    """Return the row for a program's end on Ctrl-C, and end it in any case."""
    what, wanted = "ends on Ctrl-C", "within 4 s"
    if may_have_ended and program.code == 0 and not program.was_interrupted:
        return CheckResult(what, wanted, "it has ended by itself", is_ok=True)
    if program.code is not None and not program.was_interrupted:
        return early_end(what)
    if program.code is not None or program.ends_on_interrupt():
        return CheckResult(what, wanted, "it ends", is_ok=True)
    cause, measured = why_it_goes_on(program), "it keeps running"
    return CheckResult(what, wanted, measured, is_ok=False, hint=cause.text, cause=cause.key)


def why_it_goes_on(program: CheckedProgram) -> Cause:
    """Return why a program does not end on Ctrl-C."""
    if program.takes_interrupts_as_keys():
        text = r"in a raw terminal Ctrl-C is the key '\x03': end at it, or use cbreak mode"
    else:
        text = "let the loop end at Ctrl-C: when ok() of lcmtools is false, or at SIGINT"
    return Cause("goes-on", text)


def early_end(what: str, wanted: str = "it runs") -> CheckResult:
    """Return the failed row of a program that ended too early."""
    return CheckResult(what, wanted, "it has ended", is_ok=False, cause=DIED)


def nothing_within(
    program: CheckedProgram, seconds: float, what: str, wanted: str, hint: str
) -> CheckResult:
    """Return the failed row of a program that sent nothing in time."""
    if program.code is not None:
        return early_end(what, wanted)
    measured = f"none within {seconds:g} s"
    return CheckResult(what, wanted, measured, is_ok=False, hint=hint, cause=SILENT)
