"""Reports of checks: lines of text, plain values for JSON, and JUnit's XML. Pure."""

import dataclasses
import shlex
from collections.abc import Mapping, Sequence
from typing import Any

from lcmtools.formats.junit import Case, Suite
from lcmtools.formats.junit import junit as xml_of
from lcmtools.labs.checks.results import CheckResult, Report, as_specified
from lcmtools.text_table import text_table

_LINE = "  {:6}  {:34}  {:24}  {}"
_BELOW = " " * 10


def heading(
    program: str, command: Sequence[str], *, is_answer: bool = False, is_log: bool = False
) -> list[str]:
    """Return the lines above a program's rows: the command or log, and the columns."""
    whose = "a recorded run" if is_log else "your program"
    whose = "the model answer of lcmtools" if is_answer else whose
    title = _LINE.format("", f"{program}:", "wanted", "measured")
    return ["", f"checking {whose}: {shlex.join(command)}", title]


def to_lines(result: CheckResult) -> list[str]:
    """Format a row, followed by its cause and further facts if it failed."""
    verdict = ("note" if result.findings else "ok") if result.is_ok else "NOT OK"
    found = [_LINE.format(verdict, result.what, result.wanted, result.measured)]
    if result.hint:
        found.append(f"{_BELOW}-> {result.hint}")
    if result.said and result.said not in result.hint:
        is_quote = not result.said.startswith("it printed nothing")
        found.append(f"{_BELOW}   {'it printed last: ' if is_quote else ''}{result.said}")
    return [*found, *(f"{_BELOW}   wtf: {finding}" for finding in result.findings)]


def summary(reports: Sequence[Report]) -> list[str]:
    """Summarize: the number of passed rows, and the cause of the first failure."""
    total = sum(len(report.results) for report in reports)
    found = [f"{sum(r.passed for r in reports)} of {total} are as the lab specifies"]
    first = next((report for report in reports if report.first_cause), None)
    if first is None or sum(len(r.results) - r.passed for r in reports) == 1:
        return found
    return [*found, f"first of all, {first.program}: {first.first_cause}"]


def to_json(lab: str, reports: Sequence[Report]) -> dict[str, object]:
    """Return the reports of a lab for JSON."""
    return {
        "lab": lab,
        "ok": as_specified(reports),
        "programs": {
            report.program: {
                "command": shlex.join(report.command),
                "model_answer": report.is_answer,
                "duration": round(report.duration, 1),
            }
            for report in reports
        },
        "rows": [
            {"program": report.program, **plain, "ok": plain.pop("is_ok")}
            for report in reports
            for plain in map(dataclasses.asdict, report.results)
        ],
    }


def read_json(plain: Mapping[str, Any]) -> list[Report]:
    """Return the reports in a record, which has no observations."""

    def result(row: Mapping[str, Any]) -> CheckResult:
        renamed = {**row, "is_ok": row["ok"], "findings": tuple(row["findings"])}
        return CheckResult(**{name: renamed[name] for name in CheckResult.__dataclass_fields__})

    return [
        Report(
            program,
            shlex.split(about["command"]),
            [result(row) for row in plain["rows"] if row["program"] == program],
            is_answer=about["model_answer"],
            duration=about["duration"],
        )
        for program, about in plain["programs"].items()
    ]


def junit(lab: str, submissions: Mapping[str, Sequence[Report]]) -> str:
    """Format reports as JUnit's XML: a suite for each program, a case for each row.

    Rows that follow from another row are skipped cases.
    """
    suites = [
        Suite(
            ".".join(filter(None, (name, report.program))),
            [_case(f"{lab}.{report.program}", result) for result in report.results],
            report.duration,
        )
        for name, reports in submissions.items()
        for report in reports
    ]
    return xml_of(f"lab {lab}", suites)


def _case(group: str, result: CheckResult) -> Case:
    if result.is_ok or result.follows:
        return Case(group, result.what, skipped=result.hint if result.follows else "")
    message = f"{result.measured}: {result.hint}" if result.hint else result.measured
    return Case(group, result.what, message, to_lines(result))


def _cause(report: Report) -> str:
    return f"{report.program}: {report.first_cause}" if report.program else report.first_cause


def class_rows(submissions: Mapping[str, Sequence[Report]]) -> list[str]:
    """Return a line for each submission: the passed rows of each program, and the first cause."""
    programs = (r.program for reports in submissions.values() for r in reports if r.program)
    options = list(dict.fromkeys(programs))
    cells = [("submission", *options, "first cause")]
    for name, reports in submissions.items():
        passed = {r.program: f"{r.passed} of {len(r.results)}" for r in reports}
        causes = (_cause(report) for report in reports if report.first_cause)
        cells.append((name, *(passed.get(option, "-") for option in options), next(causes, "")))
    return text_table(cells)
