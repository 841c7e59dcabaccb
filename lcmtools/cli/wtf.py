"""``lcmtools wtf``."""

import os
import sys
from collections.abc import Sequence

import click

from lcmtools.cli.options import CONTEXT, bus_options, chosen_url, duration, json_option
from lcmtools.cli.output import document, lines
from lcmtools.color import BOLD, RED, YELLOW, paint, stream_wants_color
from lcmtools.doctor.collect import collect
from lcmtools.doctor.model import Finding, Severity
from lcmtools.doctor.rules import examine

_HEADINGS = {
    Severity.ERROR: ("error(s)", "Something is wrong, and will not work as it is", "ERROR"),
    Severity.WARNING: (
        "warning(s)",
        "Warnings are things that may be just fine, but are sometimes at fault",
        "WARNING",
    ),
    Severity.NOTE: ("note(s)", "Notes are seldom at fault", "NOTE"),
}
_COLORS = {"ERROR": RED, "WARNING": YELLOW, "NOTE": BOLD}


@click.command("wtf", context_settings=CONTEXT)
@click.option("--wait", type=duration, default=1.0, help="Listen so long to the traffic (else 1s).")
@json_option
@bus_options
def command(*, wait: float, as_json: bool) -> int:
    """Look for what is wrong on the bus, and say how to mend it.

    Exits with 0 when all is well (notes count as well), 1 with warnings, 2 with errors.

    \b
    Examples:
      lcmtools wtf
      lcmtools wtf --json
    """  # noqa: D301 - \b is click's mark
    findings = list(examine(collect(chosen_url(), os.environ, wait)))
    if as_json:
        document([_record(finding) for finding in findings])
    else:
        lines(_text(findings), _colored if stream_wants_color(sys.stdout, os.environ) else str)
    return max((finding.severity for finding in findings), default=Severity.NOTE).value


def _text(findings: Sequence[Finding]) -> list[str]:
    """In roswtf's manner: a count, then each finding with its items."""
    rows: list[str] = []
    if not any(finding.severity > Severity.NOTE for finding in findings):
        rows = ["No errors or warnings", ""]
    for severity, (noun, meaning, word) in _HEADINGS.items():
        group = [finding for finding in findings if finding.severity is severity]
        if group:
            rows += [f"Found {len(group)} {noun}.", meaning, ""]
        for finding in group:
            rows.append(f"{word} {finding.text}")
            rows += finding.items
            rows += [f"   -> {remedy}" for remedy in finding.remedies]
            rows.append("")
    return rows[:-1]


def _colored(row: str) -> str:
    """A finding's first word in the colour of its severity; other lines as they are."""
    word, space, rest = row.partition(" ")
    return f"{paint(word, _COLORS[word])}{space}{rest}" if word in _COLORS else row


def _record(finding: Finding) -> dict[str, object]:
    return {
        "rule": finding.rule,
        "severity": finding.severity.name.lower(),
        "text": finding.text,
        "items": [item.strip(" *") for item in finding.items],
        "remedies": list(finding.remedies),
    }
