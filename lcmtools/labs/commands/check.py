"""``lcmtools lab check``."""

import dataclasses
from collections.abc import Callable

import click

from lcmtools.cli.completion.completer import complete, complete_files
from lcmtools.cli.options import CONTEXT, json_option, rate
from lcmtools.cli.output import document, lines
from lcmtools.labs.catalogue import LABS, find_lab
from lcmtools.labs.checks.row import Row

_ROW = "  {:6}  {:34}  {:24}  {}"


def _role_options(command: Callable[..., int]) -> Callable[..., int]:
    for lab in reversed([*LABS.values()]):
        for role in reversed(lab.roles):
            option = click.option(
                f"--{role.option}",
                metavar="COMMAND",
                help=f"Lab {lab.name}: your {role.node}.",
                shell_complete=complete_files,
            )
            command = option(command)
    return command


@click.command("check", context_settings=CONTEXT)
@click.argument("name", shell_complete=complete("lcmtools.labs.commands.completion:labs"))
@_role_options
@click.option("--rate", type=rate, help="Times real time (else 1 for yours, 4 for ours).")
@json_option
def command(name: str, *, rate: float | None, as_json: bool, **programs: str | None) -> int:
    """Check programs against a lab: yours, or, where none is given, ours.

    COMMAND is a command line in quotes. Each program runs in a simulation of its own, on a bus of
    its own; unless its command line has names of its own (:=), those of the lab are added to it.
    A viewer is given --save FILE, or the file's name in place of {picture}. The exit code is 1
    when something is not as the lab asks for.

    \b
    Examples:
      lcmtools lab check husky
      lcmtools lab check husky --controller "python my_controller.py"
      lcmtools lab check pioneer --teleop ./my_teleop --viewer "./my_viewer {picture}"
    """  # noqa: D301 - \b is click's mark
    from lcmtools.labs.checks.check import check

    chosen = {option: text for option, text in programs.items() if text is not None}
    rows: list[dict[str, object]] = []
    part = ""
    for role, row in check(find_lab(name), chosen, rate):
        rows.append({"program": role.option, **dataclasses.asdict(row)})
        if not as_json:
            lines(
                [
                    *(
                        []
                        if role.option == part
                        else ["", _ROW.format("", f"{role.option}:", "wanted", "measured")]
                    ),
                    *_told(row),
                ]
            )
        part = role.option
    is_ok = all(row["is_ok"] for row in rows)
    if as_json:
        document({"lab": name, "ok": is_ok, "rows": [_plain(row) for row in rows]})
    else:
        failed = sum(not row["is_ok"] for row in rows)
        lines([f"{len(rows) - failed} of {len(rows)} are as the lab asks for"])
    return 0 if is_ok else 1


def _told(row: Row) -> list[str]:
    """A row of the table; what to look at next stands below it."""
    verdict = "ok" if row.is_ok else "NOT OK"
    text = _ROW.format(verdict, row.what, row.wanted, row.measured)
    return [text, *([f"          -> {row.hint}"] if row.hint else [])]


def _plain(row: dict[str, object]) -> dict[str, object]:
    return {("ok" if key == "is_ok" else key): value for key, value in row.items()}
