"""``lcmtools wtf``."""

import os
import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import click

from lcmtools.cli.bus import chosen_logs, chosen_url, log_observer, notify
from lcmtools.cli.declare import duration, examples, flag, option, subcommand
from lcmtools.cli.ending import end_with_reader
from lcmtools.cli.options import bag_option, bus_choice, bus_options, json_option, part_options
from lcmtools.cli.output import (
    results_beside,
    write_data,
    write_lines,
    write_note,
    write_result,
)
from lcmtools.color import stream_wants_color
from lcmtools.doctor import report
from lcmtools.doctor.collect import USUAL, collect, unusable
from lcmtools.doctor.doubt import in_doubt, shows_signs
from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import Rule, Severity
from lcmtools.doctor.memory import Memory
from lcmtools.doctor.rules import RULES, examine
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.folders import is_standard_output
from lcmtools.names import did_you_mean


class WrongUsage(UsageError):  # noqa: N818 - named for what is wrong, as in errors.py
    """A mistake in the command line, or a file that cannot be used.

    Other errors in the choice of a bus are findings.
    """

    exit_code = 64  # by sysexits.h; 1 and 2 are warnings and errors on the bus


class JudgingCommand(click.Command):
    """A command whose exit code for wrong usage is not that of errors on the bus."""

    def make_context(self, *arguments: Any, **extra: Any) -> click.Context:  # noqa: ANN401 - click's
        """Parse the command line."""
        try:
            return super().make_context(*arguments, **extra)
        except click.UsageError as error:
            vars(error)["exit_code"] = WrongUsage.exit_code
            raise

    def invoke(self, context: click.Context) -> Any:  # noqa: ANN401 - click's
        """Run the command."""
        try:
            return super().invoke(context)
        except LcmtoolsError as error:
            if error.exit_code != LcmtoolsError.exit_code:
                raise
            raise WrongUsage(error.what, error.hint) from error


def _rule(identifier: str) -> Rule:
    by_id = {rule.id: rule for rule in RULES}
    if identifier not in by_id:
        near = did_you_mean(identifier, by_id)
        raise click.BadParameter(f"no rule '{identifier}'{f'; {near}' if near else ''}")
    return by_id[identifier]


def rule_option(*names: str, text: str, multiple: bool) -> Callable[..., Callable[..., object]]:
    """Return an option whose values are rules, by their names."""
    ids = [[rule.id, rule.summary] for rule in RULES]
    return option(*names, metavar="ID", multiple=multiple, type=_rule, help=text, completer=ids)


def judged_rules(named: Sequence[Rule]) -> Sequence[Rule]:
    """Return the rules that are named, else all; of a log those that judge messages."""
    try:
        logs = chosen_logs()
    except UsageError as error:
        raise WrongUsage(error.what, error.hint) from error
    if not logs:
        return named or RULES
    from lcmtools.doctor.recorded import OF_LOGS

    for rule in named:
        if rule.id not in OF_LOGS:
            raise WrongUsage(f"a log does not show what {rule.id} judges", "leave out --bag")
    return named or [rule for rule in RULES if rule.id in OF_LOGS]


def look_once(
    listen: float | None, *, as_json: bool, at_least: float = 0.0, memory: Memory | None = None
) -> Evidence:
    """Return the evidence; in JSON a bus that the environment names wrongly is a finding too."""
    if logs := chosen_logs():
        from lcmtools.doctor.recorded import collect_log

        evidence = collect_log(log_observer(logs))
        notify("in a log only messages are judged, not connections, computers or processes")
        return evidence
    try:
        chosen, is_usual = (listen, False) if listen is not None else (USUAL, True)
        doubts = in_doubt if is_usual else shows_signs
        evidence = collect(chosen_url(), os.environ, chosen, memory, doubts)
    except UsageError as error:
        if bus_choice().url or bus_choice().domain:
            raise WrongUsage(error.what, error.hint) from error
        if not as_json:
            raise
        evidence = unusable(error)
    if evidence.bus_problem:
        time.sleep(at_least)
    return evidence


_FILE = click.Path(dir_okay=False, readable=False, path_type=Path)


@subcommand("wtf", json_option, bus_options, bag_option, part_options(), cls=JudgingCommand)
@examples(
    "wtf",
    "wtf --ignore unconnected-publications --json",
    "wtf --explain kernel-drops",
    "wtf --watch",
    "wtf --save evidence.json",
    "wtf --from evidence.json",
    "wtf --bag ride.lcmlog",
)
@option(
    "--wait", type=duration, help="Observe for this long (else 1s, or 3.5s if there are doubts)."
)
@rule_option("--rule", "only", text="Only this rule; repeatable.", multiple=True)
@rule_option("--ignore", text="All rules except this one; repeatable.", multiple=True)
@flag("--list", "list_rules", help="List the rules.")
@rule_option("--explain", text="Explain a rule and its remedies.", multiple=False)
@flag("-w", "--watch", help="Keep running; show changes.")
@option("--save", "save_to", type=_FILE, help="Write the evidence to a file, too.")
@option("--from", "load_from", type=_FILE, help="Apply the rules to evidence from a file.")
def command(
    *,
    wait: float | None,
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
    addresses and command lines of nodes and of your LCM programs; of the messages' content it
    contains only suspicious values.
    """
    if list_rules or explain:
        shown = [explain] if explain else RULES
        rows = report.rules_text(shown, in_full=explain is not None)
        write_result([report.rule_record(rule) for rule in shown], rows, as_json=as_json)
        return 0
    rules = [rule for rule in dict.fromkeys(judged_rules(only)) if rule not in ignore]
    if not rules:
        raise WrongUsage("no rules are left", "lcmtools wtf --list shows them")
    if watch:
        if save_to or load_from or bus_choice().logs:
            raise WrongUsage("--watch keeps running; leave out --save, --from and --bag")
        every = USUAL if wait is None else wait
        look = partial(look_once, every, as_json=as_json, at_least=every, memory=Memory())
        _watch(look, rules, as_json=as_json)
    evidence = _loaded(load_from) if load_from else look_once(wait, as_json=as_json)
    if save_to:
        from lcmtools.doctor.saved import save

        save(evidence, save_to)
        if not is_standard_output(save_to):
            write_note(f"the evidence is in {save_to}")
    findings = examine(evidence, rules)
    rows, records = [], []
    if as_json:
        records = [*map(report.record, findings), *report.unchecked_records(evidence, rules)]
    else:
        rows = [*report.text(findings), *report.not_checked(evidence, rules)]
    with results_beside(save_to):
        write_result(records, rows, _decoration(), as_json=as_json)
    return max((finding.severity for finding in findings), default=Severity.NOTE).value


def _loaded(file: Path) -> Evidence:
    from lcmtools.doctor.saved import load

    return load(file)


def _watch(look: Callable[[], Evidence], rules: Sequence[Rule], *, as_json: bool) -> None:
    from lcmtools.formats.strict_json import write_json

    end_with_reader()
    for number, changes in enumerate(report.watch(look, rules)):
        if not (number or changes or as_json):
            write_data("No errors or warnings")
        for change, finding in changes:
            if as_json:
                write_data(write_json({"change": change, **report.record(finding)}))
            else:
                write_lines([*report.change_text(change, finding), ""], _decoration())


def _decoration() -> Callable[[str], str]:
    return report.colored if stream_wants_color(sys.stdout, os.environ) else str
