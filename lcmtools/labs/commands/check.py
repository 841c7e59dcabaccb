"""``lcmtools lab check``."""

from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import click

from lcmtools.cli.declare import (
    argument,
    duration,
    examples,
    option,
    rate,
    subcommand,
    whole_number,
)
from lcmtools.cli.options import json_option
from lcmtools.cli.output import results_beside, write_document, write_lines
from lcmtools.errors import UsageError, needing_extra
from lcmtools.labs.catalogue import LABS, find_lab
from lcmtools.labs.checks.results import as_specified
from lcmtools.labs.commands.lab import require_extras

_FILE = click.Path(dir_okay=False, path_type=Path)


def _program_options(command: Callable[..., int]) -> Callable[..., int]:
    for lab in reversed([*LABS.values()]):
        for program in reversed(lab.programs):
            text = f"Lab {lab.name}: your {program.node}."
            add = option(f"--{program.option}", metavar="COMMAND", help=text, completer="files")
            command = add(command)
    return command


def _check_extra(*, simulates: bool) -> None:
    """Raise MissingExtra, before anything is said of programs that could not be simulated."""
    if simulates:
        require_extras("lab check", ["sim"])
        with needing_extra("sim", "lab check needs"):
            import_module("numpy")  # it may be installed, but for another Python


@subcommand("check", json_option)
@examples(
    "lab check husky",
    "lab check husky my_controller.py",
    'lab check husky --controller "python my_controller.py __name:=mine"',
    'lab check pioneer --teleop ./my_teleop --viewer "./my_viewer {picture}"',
    'lab check husky --controller "python mine.py" --plot mine.png',
    "lab check dolly --programs class/ --junit results.xml",
    "lab check husky --bag drive.lcmlog",
    "lab check husky my_controller.py --bag drive.lcmlog",
)
@argument("name", completer="lcmtools.labs.commands.completion:labs")
@argument("files", metavar="[FILE]...", nargs=-1, completer="files")
@_program_options
@option(
    "--programs",
    "folder",
    type=click.Path(path_type=Path),
    help="Check each submission in FOLDER.",
    metavar="FOLDER",
)
@option("--jobs", type=whole_number(1), help="Programs of a class to check at a time.", metavar="N")
@option("--rate", type=rate, help="Multiple of real time (else 4, and 1 to confirm failures).")
@option("--time-limit", type=duration, help="Limit of real time for each program, once built.")
@option("--plot", type=_FILE, help="Draw velocities and the path: .png, .svg, .pdf.")
@option(
    "-b",
    "--bag",
    "log",
    metavar="FILE",
    help="Judge programs by a recorded drive, or the drive itself.",
    completer="files",
)
@option("--junit", type=_FILE, help="Write the results as JUnit's XML.")
def command(
    name: str,
    files: tuple[str, ...],
    *,
    folder: Path | None,
    jobs: int | None,
    rate: float | None,
    time_limit: float | None,
    plot: Path | None,
    log: str | None,
    junit: Path | None,
    as_json: bool,
    **programs: str | None,
) -> int:
    """Check programs against a lab: yours or, if there are none, the model answers.

    Yours are the files and package nodes of this folder with the names of the lab's programs, or
    those given as FILE, in Python or C++, which is compiled first. COMMAND is a command line in
    quotes. Each program runs in its own simulation, on its own bus; unless its command line sets
    names (:=), those of the lab are added to it. A viewer gets --save FILE, or the file's name in
    place of {picture}. The exit code is 1 if something is not as the lab specifies.

    With --programs each file or folder in FOLDER is a submission, run in its own copy; its programs
    are found by name (simple_controller.py or .cpp), or run by COMMAND with {program} in it. As
    many are checked at a time as there are processors, or as many as --jobs gives.

    With --bag nothing is simulated. Programs that are given are run with the messages of a log, as
    by lcmtools bag rerun, and what they say to them is judged: a class within seconds, on one drive
    of its teacher. Without programs, those that were recorded are judged. Checks that are not
    possible are listed.
    """
    _check_extra(simulates=not log)
    with needing_extra("sim", "lab check needs"):
        from lcmtools.labs.checks.choice import choose
        from lcmtools.labs.commands import checking

    click.get_current_context().with_resource(results_beside(junit))
    lab = find_lab(name)
    chosen = {option: text for option, text in programs.items() if text is not None}
    show = checking.show_nothing if as_json else write_lines
    if jobs and not folder:
        raise UsageError("--jobs is for --programs FOLDER", "leave it out")
    if folder and files:
        raise UsageError("--programs FOLDER checks the files in it", f"leave out {files[0]}")
    if log and (rate or time_limit or plot):
        raise UsageError("--bag simulates nothing", "leave out --rate, --time-limit and --plot")
    picture = checking.picture_file(plot)
    if log and not folder:
        runs = choose(lab, chosen, files)[0] if chosen or files else ()
        outcome = checking.check_recorded(lab, log, runs, show)
    elif folder:
        arguments = checking.class_arguments(rate, time_limit, log)
        checker = checking.class_checker(lab, chosen, arguments, picture, jobs)
        outcome = checking.check_class(lab, checker, folder, show)
    else:
        outcome = checking.check_one(
            lab, choose(lab, chosen, files), rate, time_limit, picture, show
        )
    if junit:
        checking.write_junit(junit, lab, outcome)
    write_document(outcome.record) if as_json else write_lines(outcome.summary)
    return 0 if all(map(as_specified, outcome.submissions.values())) else 1
