"""``lcmtools run``."""

import atexit
import inspect
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

import click

import lcmtools
from lcmtools.arguments import NodeArguments
from lcmtools.cli import ending
from lcmtools.cli.bus import chosen_url
from lcmtools.cli.declare import argument, examples, flag, subcommand
from lcmtools.cli.lazy import COMMAND
from lcmtools.cli.options import bus_choice, bus_options, json_option
from lcmtools.cli.output import write_note, write_result
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.escapes import ESCAPES_IN_LINES
from lcmtools.messages.type_source import shown
from lcmtools.packages.finding import find_node, own_answer
from lcmtools.packages.programs import (
    built_program,
    command_of,
    find_program,
    program_folder,
    programs_in,
)
from lcmtools.packages.runnable_nodes import OWN, NodeProgram, Runnable, runnables
from lcmtools.packages.workspace import workspace


@subcommand("run", json_option, bus_options, allow_interspersed_args=False)
@examples(
    "run sim",
    "run simple_controller __ns:=/husky0 controlled_velocity:=velocity_cmd",
    "run air_lab0 simple_controller __ns:=/husky0",
    "run ./simple_controller.py __ns:=/husky0",
    "run --list",
)
@flag("-l", "--list", "show_list", help="List the nodes that can be run.")
@argument("name", required=False, metavar="[PACKAGE] NAME", completer="runnables:programs")
@argument("arguments", nargs=-1, type=click.UNPROCESSED, completer="runnables:arguments")
def command(name: str | None, arguments: tuple[str, ...], *, show_list: bool, as_json: bool) -> int:
    """Run a node by its name, with names, remaps and parameters as in ROS.

    After NAME: __ns:=/husky0, __name:=driver, from:=to, _parameter:=value; or the same as --ns,
    --name, --param parameter:=value, --remap from:=to (-r). All other arguments are passed to the
    node. A PACKAGE in a workspace, a folder with packages, need not be installed; PACKAGE alone
    lists its nodes. NAME is also a file, as in ./node.py, or an executable file anywhere in
    PACKAGE.
    """
    if show_list and name:
        raise UsageError("--list takes no name", f"type lcmtools run {name}, or only --list")
    if name and not show_list and _is_file(name):
        from lcmtools.launch.executables import find_script  # late: most nodes are no files

        _become(find_script(name, Path.cwd()), arguments)
    known = runnables(Path.cwd())
    if name and not show_list and not _is_package(name, arguments, known):
        return _run([name, *arguments], known)
    if not name and not show_list:
        raise UsageError("the node's name is missing", "lcmtools run --list shows them")
    _list([node for node in known if name in (None, node.package)], name, as_json=as_json)
    return 0


def _is_package(name: str, arguments: Sequence[str], known: Sequence[Runnable]) -> bool:
    named = {node.name for node in known}
    packages = {one.package for one in known} | {one.name for one in workspace(Path.cwd()).packages}
    return not arguments and name in packages - named


def _is_file(name: str) -> bool:
    return ("/" in name or name.endswith(".py")) and Path(name).is_file()


def _list(nodes: Sequence[Runnable], package: str | None, *, as_json: bool) -> None:
    """Print the names of nodes, preceded by the package's name where necessary.

    Those of a package are followed by its programs.
    """
    typed = {
        node.name if node.package == (package or OWN) else f"{node.package} {node.name}": node
        for node in nodes
    }
    summaries = {name: _summary(typed[name]) for name in sorted(typed)}
    folder = program_folder(package, Path.cwd()) if package else None
    for path in programs_in(folder) if folder else ():
        summaries.setdefault(path.name, f"program {shown(path)}")
    if not summaries:
        write_note(f"lcmtools run: the package {package} has no nodes")
    width = max(map(len, summaries), default=0)
    rows = (f"{name:<{width}}  {summary}".rstrip() for name, summary in summaries.items())
    write_result(list(summaries), rows, as_json=as_json)


def _summary(node: Runnable) -> str:
    try:
        if node.source:
            built_program(node)
    except UsageError:
        return f"{node.summary()} (not built: lcmtools pkg build {node.package})".strip()
    return node.summary()


def _run(words: Sequence[str], known: Sequence[Runnable]) -> int:
    is_doubled = words[0] in words[1:2] and words[0] not in {node.package for node in known}
    words = words[is_doubled:]  # rosrun image_view image_view: the package has the node's name
    node, arguments = _find(words, known)
    others = [one.package for one in known if one.name == node.name and one.package != OWN]
    if node.package == OWN and words[0] == node.name and others:
        what = f"this is lcmtools' own {node.name}; {others[0]} has one too"
        write_note(f"lcmtools run: {what}: lcmtools run {others[0]} {node.name}")
    elif words[0] == node.name:
        from lcmtools.node.process import set_note

        set_note(own_answer(node))
    bus = bus_choice()
    chosen = NodeArguments(lcm_url=bus.url or None, domain=bus.domain or None)
    if node.package != OWN:
        atexit.unregister(ending.leave)
    try:
        program = node.load()
        typed = words[: len(words) - len(arguments)]
        click.get_current_context().meta[COMMAND] = " ".join(["lcmtools run", *typed])
        return _call(program, [*chosen.words(), *arguments]) or 0
    except KeyboardInterrupt:  # ended before the node handled signals
        return 0
    except (LcmtoolsError, OSError):
        raise
    except Exception as error:
        if node.package == OWN:
            raise
        sys.stderr.write(node.traceback(error).translate(ESCAPES_IN_LINES))
        return 1
    finally:
        lcmtools.shutdown()  # unless the node has done so


def _find(words: Sequence[str], known: Sequence[Runnable]) -> tuple[Runnable, list[str]]:
    """Return the node and its arguments; a program of a package replaces this process."""
    try:
        node, rest = find_node(words, known, Path.cwd())
    except UsageError:
        if program := find_program(words, Path.cwd()):
            _become(command_of(program), words[2:])
        raise
    if node.source:
        program = built_program(node)
        if node.source.is_file() and node.source.stat().st_mtime > program.stat().st_mtime:
            newer = f"{shown(node.source)} is newer than its program"
            write_note(f"lcmtools run: {newer}: lcmtools pkg build {node.package}")
        _become([str(program)], rest)
    return node, rest


def _become(command: Sequence[str], arguments: Sequence[str]) -> NoReturn:
    bus = bus_choice()
    is_chosen = bool(bus.url or bus.domain)
    environment = {**os.environ, **({"LCM_DEFAULT_URL": str(chosen_url())} if is_chosen else {})}
    try:
        os.execve(command[0], [*command, *arguments], environment)  # noqa: S606 - the user's own
    except OSError as error:
        raise LcmtoolsError(f"cannot start {command[-1]}: {error.strerror}") from None


def _call(program: NodeProgram, words: Sequence[str]) -> int | None:
    """Call a node's main function. One without parameters reads ``sys.argv``."""
    if inspect.signature(program).parameters:
        return program(words)
    sys.argv[1:] = words
    return program()
