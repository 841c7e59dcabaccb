"""``lcmtools lab check``."""

import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import click

from lcmtools.cli.declare import argument, duration, option, rate, subcommand
from lcmtools.cli.options import json_option
from lcmtools.cli.output import document, lines, talk
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.labs.catalogue import LABS, Lab, find_lab
from lcmtools.labs.checks.results import CheckResult, Report, as_specified

_FILE = click.Path(dir_okay=False, path_type=Path)
_CLASS_LIMIT = 120.0  # [s] for each program of a class


def _program_options(command: Callable[..., int]) -> Callable[..., int]:
    for lab in reversed([*LABS.values()]):
        for program in reversed(lab.programs):
            command = option(
                f"--{program.option}",
                metavar="COMMAND",
                help=f"Lab {lab.name}: your {program.node}.",
                completer="files",
            )(command)
    return command


@subcommand("check")
@argument("name", completer="lcmtools.labs.commands.completion:labs")
@_program_options
@option(
    "--programs",
    "folder",
    type=click.Path(path_type=Path),
    help="Check each submission in FOLDER.",
    metavar="FOLDER",
)
@option("--rate", type=rate, help="Times real time (else 1; 4 for model answers).")
@option("--time-limit", type=duration, help="Real time for each program.")
@option("--plot", type=_FILE, help="Write a PNG of velocities and the path.")
@option("--junit", type=_FILE, help="Write the results as JUnit's XML.")
@json_option
def command(
    name: str,
    *,
    folder: Path | None,
    rate: float | None,
    time_limit: float | None,
    plot: Path | None,
    junit: Path | None,
    as_json: bool,
    **programs: str | None,
) -> int:
    """Check programs against a lab: yours or, if there are none, the model answers.

    Yours are given as COMMAND; without any, they are the nodes of your workspace by their names.
    COMMAND is a command line in quotes. Each program runs in a simulation of its own, on a bus of
    its own; unless its command line has names of its own (:=), those of the lab are added to it.
    A viewer gets --save FILE, or the file's name in place of {picture}. The exit code is 1
    if something is not as the lab specifies.

    With --programs each file or folder in FOLDER is a submission, run in a copy of its own; its
    programs are found by name (simple_controller.py), or run by COMMAND with {program} in it.

    \b
    Examples:
      lcmtools lab check husky
      lcmtools lab check husky --controller "python my_controller.py"
      lcmtools lab check pioneer --teleop ./my_teleop --viewer "./my_viewer {picture}"
      lcmtools lab check husky --controller "python mine.py" --plot mine.png
      lcmtools lab check dolly --programs class/ --junit results.xml
    """
    from lcmtools.labs.checks.reporters import junit as junit_text
    from lcmtools.labs.checks.reporters import record, summary, table

    lab = find_lab(name)
    chosen = {option: text for option, text in programs.items() if text is not None}
    checker = _Checker(lab, rate, time_limit, plot, is_quiet=as_json)
    if folder is None:
        submissions = {"": checker.check(chosen)}
        report: object = record(lab.name, submissions[""])
        text: Sequence[str] = summary(submissions[""])
    else:
        submissions = checker.check_class(folder, chosen)
        report = [{"submission": one, **record(lab.name, r)} for one, r in submissions.items()]
        text = ["", *table(submissions)]
    if junit:
        _write(junit, junit_text(lab.name, submissions).encode())
    document(report) if as_json else lines(text)
    return 0 if all(map(as_specified, submissions.values())) else 1


class _Checker:
    """Checks the programs of submissions, and shows each result as it comes."""

    def __init__(
        self,
        lab: Lab,
        rate: float | None,
        time_limit: float | None,
        plot: Path | None,
        *,
        is_quiet: bool,
    ) -> None:
        self._lab, self._rate, self._time_limit, self._plot = lab, rate, time_limit, plot
        self._show = (lambda _: None) if is_quiet else lines

    def check(
        self, programs: Mapping[str, str], directory: str = "", plot_name: str = ""
    ) -> list[Report]:
        """Check the programs of one submission."""
        from lcmtools.labs.checks.check import check, choose
        from lcmtools.labs.checks.reporters import heading, result_lines

        reports: list[Report] = []
        world: Mapping[str, object] = {}
        limit = self._time_limit or float("inf")
        for run in choose(self._lab, programs, directory):
            head = list(heading(run))  # only of a program that can be started

            def show(result: CheckResult, head: list[str] = head) -> None:
                self._show([*head, *result_lines(result)])
                head.clear()

            report, world = check(self._lab, run, self._rate, limit, show)
            reports.append(report)
        if self._plot:
            from lcmtools.labs.checks.plot import plot

            file = self._plot
            if plot_name:
                file = file.with_name(f"{file.stem}_{plot_name}{file.suffix}")
            _write(file, plot(world, reports))
            talk(f"saved {file}")
        return reports

    def check_class(self, folder: Path, commands: Mapping[str, str]) -> dict[str, list[Report]]:
        """Check each submission in a folder; one that cannot be run does not end the others."""
        from lcmtools.labs.checks.submissions import submissions_in

        self._time_limit = self._time_limit or _CLASS_LIMIT
        return {path.name: self._submission(path, commands) for path in submissions_in(folder)}

    def _submission(self, path: Path, commands: Mapping[str, str]) -> list[Report]:
        from lcmtools.labs.checks.submissions import copy_submission, programs_of

        self._show(["", f"== {path.name}"])
        with tempfile.TemporaryDirectory(prefix="lcmtools-class-") as own:
            copy_submission(path, Path(own))
            programs = programs_of(self._lab, Path(own), commands)
            if not programs:
                names = " or ".join(program.node for program in self._lab.programs)
                return [_failed("", f"it has no program of this lab: {names}")]
            return [
                report
                for option, text in programs.items()
                for report in self._run(option, text, own, path.stem)
            ]

    def _run(self, option: str, text: str, directory: str, name: str) -> list[Report]:
        try:
            return self.check({option: text}, directory, f"{name}_{option}")
        except UsageError as error:
            return [_failed(option, str(error))]


def _failed(program: str, reason: str) -> Report:
    result = CheckResult("can be run", "a program", "none", is_ok=False, hint=reason)
    return Report(program, (), [result])


def _write(file: Path, data: bytes) -> None:
    try:
        file.write_bytes(data)
    except OSError as error:
        raise LcmtoolsError(f"cannot write {file}: {error.strerror}") from error
