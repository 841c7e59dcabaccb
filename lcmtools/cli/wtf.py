"""``lcmtools wtf``."""

import json
import os
import re
import sys
import time
from collections.abc import Callable, Iterator, Sequence

import click

from lcmtools.cli.completion.completer import complete
from lcmtools.cli.options import CONTEXT, bus_choice, bus_options, chosen_url, duration, json_option
from lcmtools.cli.output import data, document, lines
from lcmtools.color import BOLD, RED, YELLOW, paint, stream_wants_color
from lcmtools.doctor.collect import collect
from lcmtools.doctor.model import Evidence, Finding, Rule, Severity
from lcmtools.doctor.rules import RULES, examine
from lcmtools.doctor.unchecked import unchecked
from lcmtools.errors import UsageError
from lcmtools.names import did_you_mean

_HEADINGS = {
    Severity.ERROR: ("error(s)", "Something is wrong, and will not work as it is", "ERROR"),
    Severity.WARNING: (
        "warning(s)",
        "Warnings are things that may be just fine, but are sometimes at fault",
        "WARNING",
    ),
    Severity.NOTE: ("note(s)", "Notes are seldom at fault", "NOTE"),
}
_COLORS = {"ERROR": RED, "WARNING": YELLOW, "NOTE": BOLD, "CLEARED": BOLD}


def _known(_: click.Context, __: click.Parameter, value: Sequence[str] | str | None) -> object:
    """The rules of these ids, each once."""
    wanted = [value] if isinstance(value, str) else list(value or ())
    by_id = {rule.id: rule for rule in RULES}
    for identifier in wanted:
        if identifier not in by_id:
            near = did_you_mean(identifier, by_id)
            hint = f"; {near}" if near else ""
            raise click.BadParameter(f"no rule '{identifier}'{hint}")
    rules = [by_id[identifier] for identifier in dict.fromkeys(wanted)]
    return (rules[0] if rules else None) if isinstance(value, str | None) else rules


@click.command("wtf", context_settings=CONTEXT)
@click.option("--wait", type=duration, default=1.0, help="Listen so long to the traffic (else 1s).")
@click.option(
    "--rule",
    "only",
    metavar="ID",
    multiple=True,
    callback=_known,
    help="Only this rule; repeatable.",
    shell_complete=complete("programs:rules", is_fixed=True),
)
@click.option(
    "--ignore",
    metavar="ID",
    multiple=True,
    callback=_known,
    help="Not this rule; repeatable.",
    shell_complete=complete("programs:rules", is_fixed=True),
)
@click.option("--list", "list_rules", is_flag=True, help="List the rules.")
@click.option(
    "--explain",
    metavar="ID",
    callback=_known,
    help="Say what a rule looks at, and what helps.",
    shell_complete=complete("programs:rules", is_fixed=True),
)
@click.option(
    "-w", "--watch", "forever", is_flag=True, help="Go on, and show what appears and clears."
)
@json_option
@bus_options
def command(  # noqa: PLR0913 - one parameter an option
    *,
    wait: float,
    only: Sequence[Rule],
    ignore: Sequence[Rule],
    list_rules: bool,
    explain: Rule | None,
    forever: bool,
    as_json: bool,
) -> int:
    """Look for what is wrong on the bus, and say how to mend it.

    Exits with 0 when all is well (notes count as well), 1 with warnings, 2 with errors. What could
    not be looked at is said below, with the reason.

    \b
    Examples:
      lcmtools wtf
      lcmtools wtf --ignore unconnected-publications --json
      lcmtools wtf --explain kernel-drops
      lcmtools wtf --watch
    """  # noqa: D301 - \b is click's mark
    if list_rules or explain:
        _tell([explain] if explain else RULES, in_full=explain is not None, as_json=as_json)
        return 0
    rules = [rule for rule in only or RULES if rule not in ignore]
    if not rules:
        raise UsageError("no rule is left", "lcmtools wtf --list shows them")
    look = _evidence if as_json else _evidence_of_good_url
    if forever:
        _monitor(lambda: list(examine(look(wait, at_least=wait), rules)), as_json=as_json)
    evidence = look(wait)
    findings = list(examine(evidence, rules))
    if as_json:
        document([_record(finding) for finding in findings])
    else:
        lines([*_text(findings), *_not_checked(evidence, rules)], _decoration())
    return max((finding.severity for finding in findings), default=Severity.NOTE).value


def _evidence(listen: float, at_least: float = 0.0) -> Evidence:
    """What there is on the bus; a bus that the environment names wrongly is a finding too."""
    try:
        return _evidence_of_good_url(listen, at_least)
    except UsageError as error:
        if bus_choice().url or bus_choice().domain:
            raise
        time.sleep(at_least)
        remedy = error.hint.replace("write 'udpm:", "export LCM_DEFAULT_URL='udpm:")
        return Evidence(url="", bus_problem=error.what, bus_remedy=remedy)


def _evidence_of_good_url(listen: float, at_least: float = 0.0) -> Evidence:
    """What there is on the bus.

    Args:
        listen: How long to listen [s].
        at_least: How long it takes where the bus does not work at all [s].

    Raises:
        UsageError: The bus is named wrongly.
    """
    evidence = collect(chosen_url(), os.environ, listen)
    if evidence.bus_problem:
        time.sleep(at_least)
    return evidence


def _monitor(look: Callable[[], list[Finding]], *, as_json: bool) -> None:
    """Look again and again, without end."""
    known: dict[str, Finding] = {}
    is_first = True
    while True:
        found = {f"{finding.rule} {_constant(finding.text)}": finding for finding in look()}
        for key, finding in known.items():
            if key not in found:
                _show_change(finding, "cleared", as_json=as_json)
        for key, finding in found.items():
            if key not in known:
                _show_change(finding, "appeared", as_json=as_json)
            elif _subjects(finding) != _subjects(known[key]):
                _show_change(finding, "changed", as_json=as_json)
        if is_first and not found and not as_json:
            data("No errors or warnings")
        known, is_first = found, False


def _subjects(finding: Finding) -> set[str]:
    """What a finding is about: its items without what is measured."""
    return {_constant(item.partition(": ")[0]) for item in finding.items}


def _constant(text: str) -> str:
    """A text without its numbers, which change from look to look; not without processes'."""
    return re.sub(r"(?<!pid )(?<![\w/.:])\d[\d.]*", "#", text)


def _show_change(finding: Finding, change: str, *, as_json: bool) -> None:
    if as_json:
        data(json.dumps({"change": change, **_record(finding)}))
    elif change == "cleared":
        lines([f"CLEARED {finding.text}"], _decoration())
    else:
        lines([*_finding_text(finding), ""], _decoration())


def _tell(rules: Sequence[Rule], *, in_full: bool, as_json: bool) -> None:
    """Describe rules."""
    if as_json:
        document([_rule_record(rule) for rule in rules])
    elif in_full:
        for rule in rules:
            head = f"{rule.id} ({rule.severity.name.lower()})"
            data(f"{head}\n\n{rule.explanation}\n\n   -> {rule.remedy}")
    else:
        width = max(len(rule.id) for rule in rules)
        lines(f"{rule.id:{width}}  {rule.severity.name.lower():7}  {rule.title}" for rule in rules)


def _text(findings: Sequence[Finding]) -> list[str]:
    """In roswtf's manner: a count, then each finding with its items."""
    rows: list[str] = []
    if not any(finding.severity > Severity.NOTE for finding in findings):
        rows = ["No errors or warnings", ""]
    for severity, (noun, meaning, _) in _HEADINGS.items():
        group = [finding for finding in findings if finding.severity is severity]
        if group:
            rows += [f"Found {len(group)} {noun}.", meaning, ""]
        for finding in group:
            rows += [*_finding_text(finding), ""]
    return rows[:-1]


def _not_checked(evidence: Evidence, rules: Sequence[Rule]) -> list[str]:
    """What could not be looked at, a line each, and an empty one before."""
    asked = {rule.id for rule in rules}
    rows = [f"Not checked: {u.rule} ({u.why})" for u in unchecked(evidence) if u.rule in asked]
    return ["", *rows] if rows else []


def _finding_text(finding: Finding) -> Iterator[str]:
    yield f"{_HEADINGS[finding.severity][2]} {finding.text}"
    yield from finding.items
    yield from (f"   -> {remedy}" for remedy in finding.remedies)


def _decoration() -> Callable[[str], str]:
    return _colored if stream_wants_color(sys.stdout, os.environ) else str


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


def _rule_record(rule: Rule) -> dict[str, object]:
    return {
        "rule": rule.id,
        "severity": rule.severity.name.lower(),
        "explanation": rule.explanation,
        "remedy": rule.remedy,
    }
