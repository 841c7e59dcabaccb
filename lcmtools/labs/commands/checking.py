"""Checks of one person's programs, or of a class: their rows shown as they come."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from lcmtools.cli.output import talk
from lcmtools.errors import os_errors_as
from lcmtools.labs.catalogue import Lab
from lcmtools.labs.checks.check import check, choose
from lcmtools.labs.checks.reporters import heading, result_lines
from lcmtools.labs.checks.results import CheckResult, Report

Show = Callable[[Sequence[str]], object]


def check_one(
    lab: Lab,
    programs: Mapping[str, str],
    rate: float | None,
    time_limit: float | None,
    plot: Path | None,
    show: Show,
) -> list[Report]:
    """Check the programs of one person, and show each row as it comes."""
    reports: list[Report] = []
    world: Mapping[str, object] = {}
    for run in choose(lab, programs):
        # shown only of a program that can be started
        head = heading(run.program.option, run.command, is_answer=run.is_answer)

        def show_row(result: CheckResult, head: list[str] = head) -> None:
            show([*head, *result_lines(result)])
            head.clear()

        report, world = check(lab, run, rate, time_limit or float("inf"), show_row)
        reports.append(report)
    if plot:
        from lcmtools.labs.checks.plot import plot as plotted

        write(plot, plotted(world, reports))
        talk(f"saved {plot}")
    return reports


def show_report(show: Show, name: str, report: Report) -> None:
    """Show the rows of a program of a class, once it is done."""
    rows = [row for result in report.results for row in result_lines(result)]
    head = heading(report.program, report.command)[1:] if report.command else []
    show(["", f"== {name}", *head, *rows])


def write(file: Path, data: bytes) -> None:
    """Write a file."""
    with os_errors_as(f"cannot write {file}"):
        file.write_bytes(data)
