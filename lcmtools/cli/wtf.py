"""``lcmtools wtf``."""

import json
import os
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import click

from lcmtools.cli.completion.completer import Completer
from lcmtools.cli.declare import duration, option, subcommand
from lcmtools.cli.options import bus_choice, bus_options, chosen_url, json_option
from lcmtools.cli.output import data, lines, show, talk
from lcmtools.color import BOLD, RED, YELLOW, paint, stream_wants_color
from lcmtools.doctor import report, saved
from lcmtools.doctor.collect import collect, unusable
from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import Rule, Severity
from lcmtools.doctor.rules import RULES, examine
from lcmtools.errors import UsageError
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
    ids = Completer("programs:rules", is_fixed=True)
    return option(
        *names, metavar="ID", multiple=multiple, type=_rule, help=text, shell_complete=ids
    )


@subcommand("wtf")
@option("--wait", type=duration, default=1.0, help="Observe the traffic so long (else 1s).")
@_rule_option("--rule", "only", text="Only this rule; repeatable.", multiple=True)
@_rule_option("--ignore", text="All but this rule; repeatable.", multiple=True)
@option("--list", "list_rules", is_flag=True, help="List the rules.")
@_rule_option("--explain", text="Explain a rule and its remedies.", multiple=False)
@option("-w", "--watch", is_flag=True, help="Keep running; show changes.")
@option("--save", "save_to", type=_FILE, help="Write the evidence to a file, too.")
@option("--from", "load_from", type=_FILE, help="Apply the rules to evidence from a file.")
@json_option
@bus_options
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

    Exit codes: 0 with notes or no findings, 1 with warnings, 2 with errors. Checks that could not
    be made are listed with the reason. A file of evidence contains names, addresses and command
    lines of nodes and of your LCM programs; of the messages' content only suspicious values.

    \b
    Examples:
      lcmtools wtf
      lcmtools wtf --ignore unconnected-publications --json
      lcmtools wtf --explain kernel-drops
      lcmtools wtf --watch
      lcmtools wtf --save evidence.json
      lcmtools wtf --from evidence.json
    """
    if list_rules or explain:
        shown = [explain] if explain else RULES
        rows = report.rules_text(shown, in_full=explain is not None)
        show([report.rule_record(rule) for rule in shown], rows, as_json=as_json)
        return 0
    rules = [rule for rule in dict.fromkeys(only or RULES) if rule not in ignore]
    if not rules:
        raise UsageError("no rule is left", "lcmtools wtf --list shows them")
    if watch:
        if save_to or load_from:
            raise UsageError("--watch keeps running; leave out --save and --from")
        _watch(lambda: _look(wait, as_json=as_json, at_least=wait), rules, as_json=as_json)
    evidence = saved.load(load_from) if load_from else _look(wait, as_json=as_json)
    if save_to:
        saved.save(evidence, save_to)
        talk(f"the evidence is in {save_to}")
    findings = examine(evidence, rules)
    rows = [*report.text(findings), *report.not_checked(evidence, rules)]
    show([report.record(finding) for finding in findings], rows, _decoration(), as_json=as_json)
    return max((finding.severity for finding in findings), default=Severity.NOTE).value


def _look(listen: float, *, as_json: bool, at_least: float = 0.0) -> Evidence:
    """The evidence; in JSON a bus that the environment names wrongly is a finding too."""
    try:
        evidence = collect(chosen_url(), os.environ, listen)
    except UsageError as error:
        if not as_json or bus_choice().url or bus_choice().domain:
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
                lines([report.cleared_text(finding)], _decoration())
            else:
                lines([*report.finding_text(finding), ""], _decoration())


def _decoration() -> Callable[[str], str]:
    return _colored if stream_wants_color(sys.stdout, os.environ) else str


def _colored(row: str) -> str:
    """A finding's first word in the colour of its severity; other lines as they are."""
    word, space, rest = row.partition(" ")
    return f"{paint(word, _COLORS[word])}{space}{rest}" if word in _COLORS else row
