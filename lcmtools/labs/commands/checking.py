"""Checks of one person's programs, or of a class: their rows shown as they come."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import NamedTuple

from lcmtools.bag.log import Log
from lcmtools.cli.output import talk
from lcmtools.cli.status_line import StatusLine
from lcmtools.folders import write_whole
from lcmtools.labs.catalogue import Lab
from lcmtools.labs.checks import check_report
from lcmtools.labs.checks.check import check, choose
from lcmtools.labs.checks.check_report import class_rows, heading, junit, record, summary
from lcmtools.labs.checks.class_check import ClassCheck
from lcmtools.labs.checks.log_check import check_log
from lcmtools.labs.checks.results import CheckResult, Report

Show = Callable[[Sequence[str]], object]
_CLASS_LIMIT = 120.0  # [s] for each program of a class


class Outcome(NamedTuple):
    """The outcome of a check: reports by submission, all of it for JSON, the last lines."""

    submissions: Mapping[str, list[Report]]
    record: object
    summary: Sequence[str]


def check_one(
    lab: Lab,
    programs: Mapping[str, str],
    rate: float | None,
    time_limit: float | None,
    plot: Path | None,
    show: Show,
) -> Outcome:
    """Check the programs of one person, and show each row as it comes."""
    reports: list[Report] = []
    world: Mapping[str, object] = {}
    with StatusLine("lcmtools lab check") as waiting:
        for run in choose(lab, programs):
            # shown only of a program that can be started
            head = heading(run.program.option, run.command, is_answer=run.is_answer)
            waiting.write(f"{head[1]} ...")

            def show_row(result: CheckResult, head: list[str] = head) -> None:
                waiting.clear()
                show([*head, *check_report.rows(result)])
                head.clear()
                waiting.write("  ...")

            report, world = check(lab, run, rate, time_limit or float("inf"), show_row)
            waiting.clear()
            reports.append(report)
    if plot:
        from lcmtools.labs.checks.plot import plot as plotted

        write_whole(plot, plotted(world, reports))
        talk(f"saved {plot}")
    return Outcome({"": reports}, record(lab.name, reports), summary(reports))


def check_recorded(lab: Lab, path: str, show: Show) -> Outcome:
    """Judge a recorded run, and show its rows; and what its log does not allow to judge."""
    with Log(path) as log:
        reports, others = check_log(lab, log)
    for report in reports:
        rows = [row for result in report.results for row in check_report.rows(result)]
        show([*heading(report.program, report.command, is_log=True), *rows])
    show(["", "not judged:", *(f"  {one}" for one in others), ""] if others else [])
    extra = {"bag": path, "not_judged": list(map(asdict, others))}
    return Outcome({"": reports}, {**record(lab.name, reports), **extra}, summary(reports))


def class_arguments(rate: float | None, time_limit: float | None) -> list[str]:
    """Return the arguments of the check of each program of a class."""
    arguments = ["--time-limit", f"{time_limit or _CLASS_LIMIT:g}"]
    return [*arguments, "--rate", f"{rate:g}"] if rate else arguments


def check_class(lab: Lab, checker: ClassCheck, folder: Path, show: Show) -> Outcome:
    """Check each submission in a folder, and show the rows of each program once it is done."""
    with StatusLine("lcmtools lab check") as waiting:

        def show_report(name: str, report: Report) -> None:
            waiting.clear()
            rows = [row for result in report.results for row in check_report.rows(result)]
            head = heading(report.program, report.command)[1:] if report.command else []
            show(["", f"== {name}", *head, *rows])
            waiting.write("  ...")

        waiting.write(f"checking the submissions in {folder} ...")
        found = checker.run(folder, show_report)
        waiting.clear()
    records = [{"submission": one, **record(lab.name, reports)} for one, reports in found.items()]
    return Outcome(found, records, ["", *class_rows(found)])


def write_junit(file: Path, lab: Lab, outcome: Outcome) -> None:
    """Write results as JUnit's XML."""
    write_whole(file, junit(lab.name, outcome.submissions))
