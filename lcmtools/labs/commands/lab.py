"""``lcmtools lab list``, ``start`` and ``skeleton``."""

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

import click

from lcmtools.cli.bus import open_monitor
from lcmtools.cli.declare import argument, examples, flag, subcommand
from lcmtools.cli.options import bus_options, json_option
from lcmtools.cli.output import write_note, write_result
from lcmtools.errors import LcmtoolsError, MissingExtra, UsageError, extra_hint
from lcmtools.labs.catalogue import LABS, Lab, find_lab
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
