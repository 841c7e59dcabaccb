"""``lcmtools wtf``."""

import os
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import click

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
from lcmtools.cli.wtf_options import (
    JudgingCommand,
    WrongUsage,
    judged_rules,
    look_once,
    rule_option,
)
from lcmtools.color import stream_wants_color
from lcmtools.doctor import report
from lcmtools.doctor.collect import USUAL
from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import Rule, Severity
from lcmtools.doctor.rules import RULES, examine
from lcmtools.folders import is_standard_output

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
        write_result([report.rule_json(rule) for rule in shown], rows, as_json=as_json)
        return 0
    rules = [rule for rule in dict.fromkeys(judged_rules(only)) if rule not in ignore]
    if not rules:
        raise WrongUsage("no rules are left", "lcmtools wtf --list shows them")
    if watch:
        if save_to or load_from or bus_choice().logs:
            raise WrongUsage("--watch keeps running; leave out --save, --from and --bag")
        from lcmtools.doctor.memory import Memory

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
        records = [*map(report.to_json, findings), *report.unchecked_json(evidence, rules)]
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
                write_data(write_json({"change": change, **report.to_json(finding)}))
            else:
                write_lines([*report.change_text(change, finding), ""], _decoration())


def _decoration() -> Callable[[str], str]:
    return report.colored if stream_wants_color(sys.stdout, os.environ) else str
