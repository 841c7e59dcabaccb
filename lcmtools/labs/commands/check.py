"""``lcmtools lab check``."""

import dataclasses
from collections.abc import Callable

from lcmtools.cli.declare import argument, option, rate, subcommand
from lcmtools.cli.options import json_option
from lcmtools.cli.output import document, lines
from lcmtools.labs.catalogue import LABS, find_lab
from lcmtools.labs.checks.programs import CheckResult

_LINE = "  {:6}  {:34}  {:24}  {}"


def _role_options(command: Callable[..., int]) -> Callable[..., int]:
    for lab in reversed([*LABS.values()]):
        for role in reversed(lab.roles):
            command = option(
                f"--{role.option}",
                metavar="COMMAND",
                help=f"Lab {lab.name}: your {role.node}.",
                completer="files",
            )(command)
    return command


@subcommand("check")
@argument("name", completer="lcmtools.labs.commands.completion:labs")
@_role_options
@option("--rate", type=rate, help="Times real time (else 1; 4 for model answers).")
@json_option
def command(name: str, *, rate: float | None, as_json: bool, **programs: str | None) -> int:
    """Check programs against a lab: yours or, if none is given, the model answers.

    COMMAND is a command line in quotes. Each program runs in a simulation of its own, on a bus of
    its own; unless its command line has names of its own (:=), those of the lab are added to it.
    A viewer gets --save FILE, or the file's name in place of {picture}. The exit code is 1
    if something is not as the lab specifies.

    \b
    Examples:
      lcmtools lab check husky
      lcmtools lab check husky --controller "python my_controller.py"
      lcmtools lab check pioneer --teleop ./my_teleop --viewer "./my_viewer {picture}"
    """
    from lcmtools.labs.checks.check import check

    chosen = {option: text for option, text in programs.items() if text is not None}
    rows: list[dict[str, object]] = []
    part = ""
    for role, result in check(find_lab(name), chosen, rate):
        plain = dataclasses.asdict(result)
        rows.append({"program": role.option, **plain, "ok": plain.pop("is_ok")})
        if not as_json:
            lines([*_heading(role.option, part), *_result_lines(result)])
        part = role.option
    passed = sum(row["ok"] is True for row in rows)
    if as_json:
        document({"lab": name, "ok": passed == len(rows), "rows": rows})
    else:
        lines([f"{passed} of {len(rows)} are as the lab specifies"])
    return 0 if passed == len(rows) else 1


def _heading(role: str, before: str) -> list[str]:
    return [] if role == before else ["", _LINE.format("", f"{role}:", "wanted", "measured")]


def _result_lines(result: CheckResult) -> list[str]:
    verdict = "ok" if result.is_ok else "NOT OK"
    line = _LINE.format(verdict, result.what, result.wanted, result.measured)
    return [line, *([f"          -> {result.hint}"] if result.hint else [])]
