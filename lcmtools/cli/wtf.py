"""``lcmtools wtf``."""

import json
import os
import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import click

from lcmtools.cli.bus import chosen_url
from lcmtools.cli.declare import duration, examples, option, subcommand
from lcmtools.cli.options import bus_choice, bus_options, json_option
from lcmtools.cli.output import data, lines, show, talk
from lcmtools.color import BOLD, RED, YELLOW, paint, stream_wants_color
from lcmtools.doctor import report, saved
from lcmtools.doctor.collect import collect, unusable
from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import Rule, Severity
from lcmtools.doctor.memory import Memory
from lcmtools.doctor.rules import RULES, examine
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.names import did_you_mean

_COLORS = {"ERROR": RED, "WARNING": YELLOW, "NOTE": BOLD, "CLEARED": BOLD}
_FILE = click.Path(dir_okay=False, path_type=Path)


def _rule(identifier: str) -> Rule:
    by_id = {rule.id: rule for rule in RULES}
    if identifier not in by_id:
        near = did_you_mean(identifier, by_id)
        raise click.BadParameter(f"no rule '{identifier}'{f'; {near}' if near else ''}")
    return by_id[identifier]


def _rule_option(*names: str, text: str, multiple: bool) -> Callable[..., Callable[..., object]]:
    ids = [[rule.id, rule.title] for rule in RULES]
    return option(*names, metavar="ID", multiple=multiple, type=_rule, help=text, completer=ids)


class _WrongUsageError(UsageError):
    """A mistake in the command line, or a file that cannot be used.

    Other errors in the choice of a bus are findings.
    """

    exit_code = 64  # by sysexits.h; 1 and 2 are warnings and errors on the bus


class _Judging(click.Command):
    """A command whose exit code for wrong usage is not that of errors on the bus."""

    def make_context(self, *arguments: Any, **extra: Any) -> click.Context:  # noqa: ANN401 - click's
        """Parse the command line."""
        try:
            return super().make_context(*arguments, **extra)
        except click.UsageError as error:
            vars(error)["exit_code"] = _WrongUsageError.exit_code
            raise

    def invoke(self, context: click.Context) -> Any:  # noqa: ANN401 - click's
        """Run the command."""
        try:
            return super().invoke(context)
        except LcmtoolsError as error:
            if error.exit_code != LcmtoolsError.exit_code:
                raise
            raise _WrongUsageError(error.what, error.hint) from error


@subcommand("wtf", json_option, bus_options, cls=_Judging)
@examples(
    "wtf",
    "wtf --ignore unconnected-publications --json",
    "wtf --explain kernel-drops",
    "wtf --watch",
    "wtf --save evidence.json",
    "wtf --from evidence.json",
)
@option("--wait", type=duration, default=1.0, help="Observe the traffic so long (else 1s).")
@_rule_option("--rule", "only", text="Only this rule; repeatable.", multiple=True)
@_rule_option("--ignore", text="All but this rule; repeatable.", multiple=True)
@option("--list", "list_rules", is_flag=True, help="List the rules.")
@_rule_option("--explain", text="Explain a rule and its remedies.", multiple=False)
@option("-w", "--watch", is_flag=True, help="Keep running; show changes.")
@option("--save", "save_to", type=_FILE, help="Write the evidence to a file, too.")
@option("--from", "load_from", type=_FILE, help="Apply the rules to evidence from a file.")
def command(
    *,
    wait: float,
    only: Sequence[Rule],
    ignore: Sequence[Rule],
    list_rules: bool,
    explain: Rule | None,
    watch: bool,
    save_to: Path | None,
    load_from: Path | None,
    as_json: bool,
) -> int:
    """Report faults of the bus and of its nodes, and how to fix them.

    Exit codes: 0 with notes or no findings, 1 with warnings, 2 with errors, 64 for wrong usage or
    a file that cannot be read or written.
    Checks that could not be made are listed with the reason. A file of evidence contains names,
    addresses and command lines of nodes and of your LCM programs; of the messages' content only
    suspicious values.
    """
    if list_rules or explain:
        shown = [explain] if explain else RULES
        rows = report.rules_text(shown, in_full=explain is not None)
        show([report.rule_record(rule) for rule in shown], rows, as_json=as_json)
        return 0
    rules = [rule for rule in dict.fromkeys(only or RULES) if rule not in ignore]
    if not rules:
        raise _WrongUsageError("no rule is left", "lcmtools wtf --list shows them")
    if watch:
        if save_to or load_from:
            raise _WrongUsageError("--watch keeps running; leave out --save and --from")
        memory = Memory()
        look = partial(_look, wait, as_json=as_json, at_least=wait, memory=memory)
        _watch(look, rules, as_json=as_json)
    evidence = saved.load(load_from) if load_from else _look(wait, as_json=as_json)
    if save_to:
        saved.save(evidence, save_to)
        talk(f"the evidence is in {save_to}")
    findings = examine(evidence, rules)
    rows = [*report.text(findings), *report.not_checked(evidence, rules)]
    records = [*map(report.record, findings), *report.unchecked_records(evidence, rules)]
    show(records, rows, _decoration(), as_json=as_json)
    return max((finding.severity for finding in findings), default=Severity.NOTE).value


def _look(
    listen: float, *, as_json: bool, at_least: float = 0.0, memory: Memory | None = None
) -> Evidence:
    """The evidence; in JSON a bus that the environment names wrongly is a finding too."""
    try:
        evidence = collect(chosen_url(), os.environ, listen, memory)
    except UsageError as error:
        if bus_choice().url or bus_choice().domain:
            raise _WrongUsageError(error.what, error.hint) from error
        if not as_json:
            raise
        evidence = unusable(error)
    if evidence.bus_problem:
        time.sleep(at_least)
    return evidence


def _watch(look: Callable[[], Evidence], rules: Sequence[Rule], *, as_json: bool) -> None:
    for number, changes in enumerate(report.watch(look, rules)):
        if not (number or changes or as_json):
            data("No errors or warnings")
        for change, finding in changes:
            if as_json:
                data(json.dumps({"change": change, **report.record(finding)}))
            elif change == "cleared":
                lines([*report.cleared_text(finding), ""], _decoration())
            else:
                lines([*report.finding_text(finding), ""], _decoration())


def _decoration() -> Callable[[str], str]:
    return _colored if stream_wants_color(sys.stdout, os.environ) else str


def _colored(row: str) -> str:
    """A finding's first word in the colour of its severity; other lines as they are."""
    word, space, rest = row.partition(" ")
    return f"{paint(word, _COLORS[word])}{space}{rest}" if word in _COLORS else row
