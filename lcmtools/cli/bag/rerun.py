"""``lcmtools bag rerun``."""

import os
from pathlib import Path
from typing import Any

import click

from lcmtools.bag.rerunning.programs import Program, Tested, tested
from lcmtools.bag.rerunning.rerun import rerun
from lcmtools.bag.rerunning.rerun_report import draw, to_json, to_lines
from lcmtools.bag.rerunning.rerun_report import junit as junit_of
from lcmtools.bag.rerunning.rerun_report import save as save_log
from lcmtools.cli.bag.common import force_option, not_negative, window_options
from lcmtools.cli.declare import argument, duration, examples, flag, option, rate, subcommand
from lcmtools.cli.options import json_option
from lcmtools.cli.output import write_result
from lcmtools.cli.status_line import StatusLine
from lcmtools.errors import UsageError
from lcmtools.folders import write_whole
from lcmtools.launch.file import read_file, read_words
from lcmtools.launch.packages import find_files
from lcmtools.launch.reading import make_plan
from lcmtools.observe.measuring.curves import check_suffix
from lcmtools.settings import usual_namespace

_limit = not_negative("it must not be negative")


@subcommand("rerun", force_option, json_option)
@examples(
    "bag rerun drive.lcmlog -- lcmtools run simple_controller __ns:=/husky0",
    "bag rerun drive.lcmlog --launch husky.launch --tolerance 1e-6 --junit result.xml",
    "bag rerun lab.lcmlog --output CONTROL -- ./my_c_program",
)
@argument("file", metavar="LOG", completer="files")
@argument("program", nargs=-1, type=click.UNPROCESSED, metavar="[-- PROGRAM...]")
@option("--launch", metavar="FILE", completer="files", help="Run the nodes of a launch file.")
@option(
    "--input",
    "only",
    multiple=True,
    metavar="TOPIC",
    completer="logs:topics",
    help="Play only this topic; may be repeated.",
)
@option(
    "--output",
    "outputs",
    multiple=True,
    metavar="TOPIC",
    completer="logs:topics",
    help="Compare this topic, too, and do not play it.",
)
@window_options
@option("--tolerance", type=_limit, help="Largest difference of numbers (else 1e-9).")
@option("--relative", type=_limit, help="The same, as a part of their size (else 1e-9).")
@option("--delay", type=duration, help="Largest difference of times (else 100ms).")
@option("--against", metavar="CONTRACT", completer="files", help="A YAML file with tolerances.")
@flag("--twice", help="Run it twice, and compare both runs byte for byte.")
@option("--rate", type=rate, help="Play in real time at this rate, not in lock-step.")
@option("--timeout", type=duration, help="Time after which it hangs (else 10s).")
@option("--junit", type=click.Path(path_type=Path), metavar="FILE", help="Write JUnit's XML.")
@option("--save", metavar="OUT", completer="files", help="Write a log with the new outputs.")
@option("--plot", type=click.Path(path_type=Path), metavar="FILE", help="Draw what differs.")
@flag("-q", "--quiet", help="Show no progress.")
def command(
    file: str,
    program: tuple[str, ...],
    *,
    launch: str | None,
    junit: Path | None,
    save: str | None,
    plot: Path | None,
    quiet: bool,
    force: bool,
    as_json: bool,
    **manner: Any,  # noqa: ANN401 - of Manner
) -> int:
    """Run a program with a recording, and compare what it publishes with what was recorded.

    The program runs on a bus of its own. It gets the messages that it subscribes to, except on the
    topics that it publishes; these are compared. Nodes of lcmtools, in Python and C++, are played
    to in lock-step: each message when the callbacks of the one before have ended, with the log's
    time for their clocks and timers. Other programs, and those that wait for the computer's clock,
    are played to in real time. Several programs are those of a launch file.

    The exit code is 1 if anything differs, or if the program ends, hangs or raises.
    """
    if plot:
        check_suffix(plot)
    typed = {name: value for name, value in manner.items() if value is not None}
    with StatusLine("lcmtools bag rerun", is_quiet=quiet) as line:
        result = rerun(
            file,
            _programs(program, launch),
            lambda part: line.write(f"{file}: {100 * part:.0f} %"),
            **typed,
        )
        line.clear()
    write_result(to_json(result), to_lines(result), as_json=as_json)
    if save:
        save_log(result, save, force=force)
    if junit:
        write_whole(junit, junit_of(result))
    if plot and not result:
        draw(result, plot)
    return 0 if result else 1


def _programs(words: tuple[str, ...], launch: str | None) -> Tested:
    """Return the programs to run; UsageError unless there is either a command or a launch file."""
    if launch is None:
        if not words:
            raise UsageError("the program is missing", "write it after --, or --launch FILE")
        return tested(words)
    typed = read_words([launch, *words], None, usual_namespace(os.environ))
    files = [read_file(path) for path in find_files(typed.places)]
    nodes = make_plan(files, typed.arguments, typed.namespace, os.environ).nodes
    return Tested([Program(one.name, one.command, one.environment, one.directory) for one in nodes])
