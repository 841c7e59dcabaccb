"""``lcmtools lab``."""

from collections.abc import Callable, Sequence
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import click

from lcmtools.cli.bus import open_monitor
from lcmtools.cli.declare import (
    argument,
    duration,
    examples,
    flag,
    option,
    rate,
    subcommand,
    whole_number,
)
from lcmtools.cli.options import bus_options, json_option
from lcmtools.cli.output import (
    results_beside,
    write_document,
    write_lines,
    write_note,
    write_result,
)
from lcmtools.errors import LcmtoolsError, MissingExtra, UsageError, extra_hint, needing_extra
from lcmtools.labs.catalogue import LABS, Lab, find_lab
from lcmtools.labs.checks.results import as_specified
from lcmtools.labs.skeletons import CPP_NAMES, NAMES, copy_skeleton
from lcmtools.text_table import text_table

_MODULES = {"sim": ("numpy", "PIL", "pybullet mujoco"), "web": ("websockets",)}
"""The modules of each extra; of those in one text, one is enough."""


@subcommand("list", json_option)
@examples("lab list", "lab list --json")
def list_labs(*, as_json: bool) -> None:
    """List the labs."""
    rows = text_table([(lab.name, lab.title) for lab in LABS.values()])
    write_result(list(map(_plain, LABS.values())), rows, as_json=as_json)


def _plain(lab: Lab) -> dict[str, object]:
    programs = {
        program.option: " ".join((*program.answer, *program.arguments)) for program in lab.programs
    }
    plain = {"name": lab.name, "title": lab.title, "world": lab.world}
    return {**plain, "programs": programs, "steps": [*lab.steps]}


@subcommand("start", bus_options, ignore_unknown_options=True)
@examples("lab start husky", "lab start pioneer --no-view")
@flag("--view/--no-view", "opens_view", default=True, help="Show the world in the browser, or not.")
@argument("name", completer="lcmtools.labs.commands.completion:labs")
@argument(
    "arguments",
    nargs=-1,
    type=click.UNPROCESSED,
    completer="lcmtools.labs.commands.completion:simulator_arguments",
)
@click.pass_context
def start(ctx: click.Context, name: str, arguments: tuple[str, ...], *, opens_view: bool) -> int:
    """Run a lab's simulator until Ctrl-C, show its world, and say what to type next.

    The world opens in the browser where there is a display, else its address is printed.
    ARGUMENTS are passed to the simulator: --rate 4, --paused; see lcmtools run sim --help.
    """
    from lcmtools.cli import run

    lab = find_lab(name)
    require_extras("lab start", ["sim", "web"] if opens_view else ["sim"])
    with open_monitor("lab_start") as monitor:
        nodes = {node.name for node in monitor.settle(foreign=False).nodes if not node.stale}
    if lab.simulator in nodes:
        raise LcmtoolsError(
            f"{lab.simulator} is already running on this bus",
            "end it with Ctrl-C where it runs, or use another bus: --domain 3",
        )
    steps = (f"  {step}" for step in lab.steps)
    for row in (lab.title, "In a second terminal, type:", *steps, "Ctrl-C ends the simulator."):
        write_note(row)
    if opens_view:
        write_note("The robot is shown in the browser; the address comes below.")
    words = ("sim", "--world", lab.world, *(["--view"] if opens_view else []), *arguments)
    own = {"name": "lcmtools", "arguments": words}
    return int(ctx.invoke(run.command, **own, show_list=False, as_json=False))


def require_extras(command: str, extras: Sequence[str]) -> None:
    """Raise MissingExtra that names all extras of a command that are not installed."""
    missing = [extra for extra in extras if not all(map(_is_installed, _MODULES[extra]))]
    if missing:
        names = " and ".join(f"'{extra}'" for extra in missing)
        what = f"{command} needs the extra{'s' * (len(missing) > 1)} {names}"
        hint = "; --no-view starts the simulator alone" if missing == ["web"] else ""
        raise MissingExtra(what, extra_hint(",".join(missing)) + hint)


def _is_installed(modules: str) -> bool:
    return any(find_spec(module) for module in modules.split())


@subcommand("skeleton", json_option)
@examples(
    "lab skeleton simple_controller",
    "lab skeleton kinect_viewer my_lab",
    "lab skeleton moving_robot --cpp",
)
@flag("-l", "--list", "show_list", help="List the skeletons.")
@flag("--cpp", "is_cpp", help="In C++, not Python.")
@flag("--force", help="Overwrite an existing file.")
@argument("name", required=False, completer="lcmtools.labs.commands.completion:skeletons")
@argument("folder", metavar="[DIR]", default=".", type=click.Path(path_type=Path))
def skeleton(
    name: str | None, folder: Path, *, show_list: bool, is_cpp: bool, force: bool, as_json: bool
) -> None:
    """Copy a lab's node with TODOs into DIR (else here), to complete.

    It runs unchanged, with python or compiled; its first lines show the command.
    """
    if show_list and name:
        raise UsageError("--list cannot be used with a skeleton's name", "leave out one of them")
    if show_list:
        names = CPP_NAMES if is_cpp else NAMES
        write_result(list(names), names, as_json=as_json)
        return
    if not name:
        raise UsageError(
            "the skeleton's name is missing", "lcmtools lab skeleton --list shows them"
        )
    path = copy_skeleton(name, folder, is_cpp=is_cpp, overwrite=force)
    write_result({"file": str(path)}, [str(path)], as_json=as_json)
    run = "and compile it as its first lines show" if is_cpp else f"and run it: python {path}"
    write_note(f"fill in its TODOs, {run}")


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
def check(
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
