"""Checks of a user's programs, of a recorded run or of a class, with their rows printed at once."""

import os
import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import NamedTuple

from lcmtools.bag.log import Log
from lcmtools.cli.output import write_note
from lcmtools.cli.status_line import StatusLine
from lcmtools.errors import MissingExtra
from lcmtools.folders import write_whole
from lcmtools.labs.catalogue import Lab
from lcmtools.labs.checks import check_report
from lcmtools.labs.checks.check import check
from lcmtools.labs.checks.check_report import class_rows, heading, junit, summary, to_json
from lcmtools.labs.checks.choice import Run
from lcmtools.labs.checks.class_check import ClassCheck
from lcmtools.labs.checks.log_check import check_log
from lcmtools.labs.checks.plot import draw_check
from lcmtools.labs.checks.rerun_check import check_rerun
from lcmtools.labs.checks.results import CheckResult, Report
from lcmtools.labs.checks.submissions import programs_named
from lcmtools.observe.measuring.curves import check_suffix, empty_figure

Show = Callable[[Sequence[str]], object]
_USUAL = 10  # [s] that the check of a right program takes
_COMPILING = "about 20 s if it has changed"
_LONGER = "longer if something fails"
_CLASS_LIMIT = 120.0  # [s] for each program of a class


def show_nothing(_: Sequence[str]) -> None:
    """Show no rows, and no note before them: the record that is written at the end has all."""


def picture_file(plot: Path | None) -> Path | None:
    """Return the file of a picture; None where it needs an extra that is missing, and say so.

    Raises:
        UsageError: The file's suffix is not one of a picture.
    """
    if plot is None:
        return None
    check_suffix(plot)
    try:
        empty_figure(1, 1)
    except MissingExtra as error:
        write_note(f"lcmtools lab check: {error}; checking without a picture")
        return None
    return plot


class Outcome(NamedTuple):
    """The outcome of a check: reports by submission, the record for JSON, the last lines."""

    submissions: Mapping[str, list[Report]]
    record: object
    summary: Sequence[str]


def check_one(
    lab: Lab,
    choice: tuple[Sequence[Run], str],
    rate: float | None,
    time_limit: float | None,
    plot: Path | None,
    show: Show,
) -> Outcome:
    """Check a user's programs, and show each row at once."""
    runs, found = choice
    reports: list[Report] = []
    world: Mapping[str, object] = {}
    with StatusLine("lcmtools lab check") as waiting:
        if show is not show_nothing:
            if found:
                waiting.write_note(found)
            waiting.write_note(_announced(runs))
        for run in runs:
            # shown only of a program that can be started
            head = heading(run.program.option, run.command, is_answer=run.is_answer)
            waiting.write(f"{head[1]} ...")

            def show_row(result: CheckResult, head: list[str] = head) -> None:
                waiting.clear()
                show([*head, *check_report.to_lines(result)])
                head.clear()
                waiting.write("  ...")

            report, world = check(lab, run, rate, time_limit or float("inf"), show_row)
            waiting.clear()
            reports.append(report)
    if plot:
        draw_check(world, reports, plot)
        write_note(f"saved {plot}")
    return Outcome({"": reports}, to_json(lab.name, reports), summary(reports))


def _announced(runs: Sequence[Run]) -> str:
    """Return what a check of programs does, and how long it takes."""
    each = "a program" if len(runs) == 1 else f"{len(runs)} programs, one after the other"
    text = f"simulates {each}: about {sum(run.program.check_time for run in runs):.0f} s, {_LONGER}"
    sources = " and ".join(run.source.name for run in runs if run.source)
    return f"compiles {sources} ({_COMPILING}), and {text}" if sources else text


def check_recorded(lab: Lab, path: str, runs: Sequence[Run], show: Show) -> Outcome:
    """Check programs that are run with a recorded drive; without any, the recorded run itself.

    Its rows and the requirements that were not judged are shown.
    """
    if runs:
        found = [check_rerun(lab, run, path) for run in runs]
        reports = [one for one, _ in found if one]
        others = [other for _, some in found for other in some]
    else:
        with Log(path) as log:
            reports, others = check_log(lab, log)
        here = [str(files[0]) for files in programs_named(lab, Path.cwd()).values()]
        if here and show is not show_nothing:
            typed = f"lcmtools lab check {lab.name} {shlex.join((*here, '--bag', path))}"
            write_note(f"judges the recording itself; {typed} runs what is here with it")
    for report in reports:
        rows = [row for result in report.results for row in check_report.to_lines(result)]
        show([*heading(report.program, report.command, is_log=not runs), *rows])
    show(["", "not judged:", *(f"  {requirement}" for requirement in others), ""] if others else [])
    extra = {"bag": path, "not_judged": list(map(asdict, others))}
    return Outcome({"": reports}, {**to_json(lab.name, reports), **extra}, summary(reports))


def class_arguments(rate: float | None, time_limit: float | None, log: str | None) -> list[str]:
    """Return the arguments of the check of each program of a class."""
    if log:
        return ["--bag", str(Path(log).absolute())]
    arguments = ["--time-limit", f"{time_limit or _CLASS_LIMIT:g}"]
    return arguments + ([f"--rate={rate:g}"] if rate else [])


def class_checker(
    lab: Lab,
    programs: Mapping[str, str],
    arguments: Sequence[str],
    plot: Path | None,
    jobs: int | None,
) -> ClassCheck:
    """Return the check of a class: ``jobs`` programs at a time, or one for each processor."""
    return ClassCheck(lab, programs, arguments, plot, jobs or os.cpu_count() or 1)


def check_class(lab: Lab, checker: ClassCheck, folder: Path, show: Show) -> Outcome:
    """Check each submission in a folder, and show the rows of each finished program."""
    with StatusLine("lcmtools lab check") as waiting:

        def show_report(name: str, report: Report) -> None:
            waiting.clear()
            rows = [row for result in report.results for row in check_report.to_lines(result)]
            head = heading(report.program, report.command)[1:] if report.command else []
            show(["", f"== {name}", *head, *rows])
            waiting.write("  ...")

        if show is not show_nothing:
            text = f"simulates the programs, {checker.jobs} at a time: about {_USUAL} s each,"
            played = f"runs the programs with the recorded drive, {checker.jobs} at a time"
            waiting.write_note(played if checker.is_played else f"{text} {_LONGER}")
        waiting.write(f"checking the submissions in {folder} ...")
        found = checker.run(folder, show_report)
        waiting.clear()
    records = [
        {"submission": name, **to_json(lab.name, reports)} for name, reports in found.items()
    ]
    return Outcome(found, records, ["", *class_rows(found)])


def write_junit(file: Path, lab: Lab, outcome: Outcome) -> None:
    """Write results as JUnit's XML."""
    write_whole(file, junit(lab.name, outcome.submissions))
