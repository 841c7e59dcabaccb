"""The parts of ``wtf``: its exit codes, the options that name rules, and one look at the bus.

Wrong usage needs an exit code of its own, for 1 and 2 are warnings and errors on the bus.
"""

import os
import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import click

from lcmtools.cli.bus import chosen_logs, chosen_url, log_observer, notify
from lcmtools.cli.declare import option
from lcmtools.cli.options import bus_choice
from lcmtools.doctor.collect import USUAL, collect, unusable
from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import Rule
from lcmtools.doctor.rules import RULES, in_doubt, shows_signs
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.names import did_you_mean

if TYPE_CHECKING:
    from lcmtools.doctor.memory import Memory


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
    listen: float | None, *, as_json: bool, at_least: float = 0.0, memory: "Memory | None" = None
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
