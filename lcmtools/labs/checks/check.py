"""The check of a lab: each program runs on its own test bench."""

import contextlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.labs.catalogue import Lab, LabProgram
from lcmtools.labs.checks import dolly, husky, path, teleop, viewer
from lcmtools.labs.checks.checked_programs import check_startable, split_command
from lcmtools.labs.checks.diagnosis import DIED, RAISED, SAME, cause_of, raised
from lcmtools.labs.checks.observations import Observations, last_failure, last_words
from lcmtools.labs.checks.results import Cause, CheckResult, Report
from lcmtools.labs.checks.test_bench import TestBench, TimeLimitReached
from lcmtools.packages.cmake import built_source
from lcmtools.packages.cpp_nodes import is_cpp
from lcmtools.packages.finding import find_node
from lcmtools.packages.programs import built_program, find_program
from lcmtools.packages.runnable_nodes import runnables
from lcmtools.packages.workspace import workspace

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


@dataclass(frozen=True, slots=True)
class Run:
    """A program to be checked."""

    program: LabProgram  # the lab's program that it implements
    command: Sequence[str]  # its command line
    is_answer: bool = False  # True for the model answer of lcmtools


def choose(lab: Lab, programs: Mapping[str, str]) -> list[Run]:
    """Return the programs to check. The lab's names are added to commands without names.

    ``programs`` are the student's command lines by option. Without any, the workspace's nodes and
    scripts with the names of the lab's programs are checked, or the model answers if there are no
    such nodes.

    Raises:
        UsageError: A program belongs to another lab or does not exist, a command line is wrong,
            or a file of the workspace is not declared as a node, not built or not executable.
    """
    known = {program.option: program for program in lab.programs}
    may_be_answer = any(text.startswith("lcmtools run") for text in programs.values())
    nodes = _workspace_nodes(lab) if may_be_answer or not programs else {}
    if not programs:
        nodes = _workspace_scripts(lab) | nodes
    if not programs and not nodes:
        return [Run(p, [*p.answer, *p.arguments], is_answer=True) for p in lab.programs]
    chosen = []
    programs = programs or {option: f"lcmtools run {node}" for option, node in nodes.items()}
    for option, text in programs.items():
        if option not in known:
            hint = ", ".join(f"--{name}" for name in known)
            raise UsageError(f"--{option} is not a program of the lab {lab.name}", f"it has {hint}")
        words = split_command(text)
        check_startable(words)
        is_answer = tuple(words[:3]) == known[option].answer and option not in nodes
        if not any(":=" in word for word in words):
            words += known[option].arguments
        chosen.append(Run(known[option], words, is_answer))
    return chosen


def _workspace_nodes(lab: Lab) -> dict[str, str]:
    """Return the workspace's nodes with the names of a lab's programs, by option."""
    found = {}
    known, here = runnables(Path.cwd()), Path.cwd()
    for program in lab.programs:
        node, _ = find_node([program.node], known, here)
        if node.source:
            built_program(node)  # or raise
        if node.folder:
            found[program.option] = f"{node.package} {node.name}"
    return found


def _workspace_scripts(lab: Lab) -> dict[str, str]:
    """Return the scripts of the workspace's packages with these names, likewise."""
    here = Path.cwd()
    near = [one.name for one in workspace(here).packages if not one.is_noted]
    return {
        program.option: f"{package} {script.name}"
        for program in lab.programs
        for package in near
        if (script := find_program([package, program.node], here))
    }


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
            command = owned.enter_context(_built(run.command))
        except LcmtoolsError as error:
            what, hint = "can be built", str(error)
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
def _built(command: Sequence[str]) -> Iterator[Sequence[str]]:
    """Build a source in C++; yield the command line with its program, or as it is."""
    source, *arguments = command
    if not is_cpp(Path(source)):
        yield command
        return
    with built_source(Path(source)) as program:
        yield [str(program), *arguments]


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
    if is_ok and (look := bench.observe().look) and look.findings:
        found = "1 finding" if len(look.findings) == 1 else f"{len(look.findings)} findings"
        row = CheckResult("what wtf says about it", "nothing", found, is_ok=True)
        yield replace(row, findings=tuple(look.findings))
    yield program.check_ctrl_c(may_have_ended=run.program.may_end)


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
