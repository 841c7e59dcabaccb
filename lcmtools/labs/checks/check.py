"""The check of a lab: each program runs on its own test bench."""

import contextlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from lcmtools.errors import LcmtoolsError
from lcmtools.labs.catalogue import Lab
from lcmtools.labs.checks import dolly, husky, path, teleop, viewer
from lcmtools.labs.checks.choice import Run
from lcmtools.labs.checks.diagnosis import DIED, RAISED, SAME, busy, cause_of, raised, slip
from lcmtools.labs.checks.observations import Observations, last_failure, last_words
from lcmtools.labs.checks.program_rows import ends_on_ctrl_c
from lcmtools.labs.checks.results import Cause, CheckResult, Report
from lcmtools.labs.checks.test_bench import TestBench, TimeLimitReached
from lcmtools.packages.cmake import built_source
from lcmtools.text_table import plural

Check = Callable[[TestBench, Sequence[str]], Iterator[CheckResult]]

CHECKS: Mapping[str, Check] = {
    "controller": husky.check_controller,
    "evaluator": husky.check_evaluator,
    "teleop": teleop.check_teleop,
    "viewer": viewer.check_viewer,
    "path": path.check_path,
    "mover": dolly.check_mover,
    "reader": dolly.check_reader,
}
"""By the program's option."""

_NOTHING_SAID = "it printed nothing"


def check(
    lab: Lab,
    run: Run,
    rate: float | None = None,
    time_limit: float = float("inf"),
    show: Callable[[CheckResult], object] = lambda _: None,
) -> tuple[Report, Mapping[str, Any]]:
    """Check a program on its own test bench; return the report and the content of the world file.

    It runs at ``rate`` simulated seconds per second (None: a suitable one), for at most
    ``time_limit`` [s] of real time. ``show`` is called with each result at once.

    A source in C++ is built first, which the time limit does not count: it is the computer's. If
    that fails, this is the only row.

    Raises:
        UsageError: The program cannot be started.
        LcmtoolsError: The simulator does not start.
    """
    results: list[CheckResult] = []
    with contextlib.ExitStack() as owned:
        try:
            command = owned.enter_context(built(run))
        except LcmtoolsError as error:
            what, hint = "can be built", "; ".join(filter(None, (str(error), slip(str(error)))))
            row = CheckResult(what, "a program", "none", is_ok=False, hint=hint, cause="not-built")
            show(row)
            return Report(run.program.option, run.command, [row]), {}
        bench = owned.enter_context(TestBench(lab, run.program, rate, time_limit))
        explanation = Explanation(bench.observe)
        for result in _limited(_rows(bench, replace(run, command=command)), time_limit):
            explained = explanation.of(result)
            if result.cause == RAISED and explained.follows:
                continue  # it has been reported as the cause of another row
            results.append(explained)
            show(explained)
            if explained.cause == DIED:
                break  # nothing more can be asked of it
        observed = bench.observe() if bench.program else None
        duration = bench.recorder.duration
    report = Report(run.program.option, run.command, results, observed, run.is_answer, duration)
    return report, bench.world


@contextlib.contextmanager
def built(run: Run) -> Iterator[Sequence[str]]:
    """Build a source in C++; yield the command line with its program, or as it is."""
    if run.source is None:
        yield run.command
        return
    with built_source(run.source) as program:
        yield [str(program), *run.command[1:]]


def _rows(bench: TestBench, run: Run) -> Iterator[CheckResult]:
    """Return the lab's own rows, and those of each program."""
    is_ok = True
    for result in CHECKS[run.program.option](bench, run.command):
        yield result
        is_ok = is_ok and result.is_ok
    program = bench.program
    if program is None:
        return
    if exception := _exception(bench):
        yield exception
    if is_ok and run.program.publishes and (slow := busy(bench.observe(), often=True)):
        what, wanted = "callbacks return at once", "well below 0.1 s"
        yield CheckResult(what, wanted, "they do not", is_ok=False, hint=slow.text, cause=slow.key)
    if is_ok and (look := bench.observe().look) and look.findings:
        found = plural(len(look.findings), "finding")
        row = CheckResult("what wtf says about it", "nothing", found, is_ok=True)
        yield replace(row, findings=tuple(look.findings))
    yield ends_on_ctrl_c(program, may_have_ended=run.program.may_end)


def _exception(bench: TestBench) -> CheckResult | None:
    """Return a row for an exception that the program has printed; None if there is none."""
    assert bench.program is not None
    if failure := last_failure(bench.program.printed()):
        cause = raised(bench.observe()) or Cause(RAISED, str(failure))
        what, name = "raises no exception", failure.exception
        return CheckResult(what, "none", name, is_ok=False, hint=cause.text, cause=RAISED)
    return None


def _limited(results: Iterator[CheckResult], time_limit: float) -> Iterator[CheckResult]:
    try:
        yield from results
    except TimeLimitReached:
        wanted = f"within {time_limit:g} s"
        hint = "the check of this program was aborted"
        yield CheckResult("is checked in time", wanted, "it takes longer", is_ok=False, hint=hint)


@dataclass
class Explanation:
    """Explains failed rows: each cause is named once, in the first row that it affects."""

    observe: Callable[[], Observations]
    _first: dict[str, str] = field(default_factory=dict)
    _last: str = ""

    def of(self, result: CheckResult) -> CheckResult:
        """Return a row with its cause, or with an earlier row of the same cause."""
        if result.is_ok:
            return replace(result, hint="", cause="")
        observed = self.observe()
        cause = Cause(self._last, "") if result.cause == SAME else cause_of(result, observed)
        first = self._first.setdefault(cause.key, result.what)
        self._last = cause.key
        if first != result.what:
            hint = f"follows from: {first}"
            return replace(result, hint=hint, cause=cause.key, follows=first)
        said = last_words(observed.printed) or _NOTHING_SAID
        is_first = len(self._first) == 1
        findings = tuple(observed.look.findings) if is_first and observed.look else ()
        hint = cause.text
        return replace(result, hint=hint, cause=cause.key, said=said, findings=findings)
