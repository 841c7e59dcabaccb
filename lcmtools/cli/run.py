"""``lcmtools run``."""

from collections.abc import Sequence
from importlib.metadata import EntryPoint, entry_points
from typing import Protocol, cast

import click

from lcmtools.cli.lazy import COMMAND
from lcmtools.cli.options import CONTEXT, bus_choice, bus_options, json_option
from lcmtools.cli.output import document, lines
from lcmtools.errors import MissingExtra, UsageError
from lcmtools.names import did_you_mean

GROUP = "lcmtools.nodes"
"""The entry points that are nodes; any installed package can add its own."""


class Program(Protocol):
    """A node's main function."""

    def __call__(self, args: Sequence[str] | None = None) -> int | None:
        """Run until asked to end; return an exit code, None for 0."""
        ...


@click.command("run", context_settings={**CONTEXT, "allow_interspersed_args": False})
@click.option("-l", "--list", "show_list", is_flag=True, help="List the nodes that can be run.")
@json_option
@bus_options
@click.argument("name", required=False)
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED)
def command(name: str | None, arguments: tuple[str, ...], *, show_list: bool, as_json: bool) -> int:
    """Run a node by its name, with names, remaps and parameters as ROS writes them.

    After NAME: __ns:=/husky0, __name:=driver, from:=to, _parameter:=value; or the same as
    --ns, --name, --remap from:=to (-r), --param parameter:=value. Everything else is the node's.

    \b
    Examples:
      lcmtools run sim
      lcmtools run simple_controller __ns:=/husky0 controlled_velocity:=velocity_cmd
      lcmtools run --list
    """  # noqa: D301 - \b is click's mark
    known = {entry.name: entry for entry in entry_points(group=GROUP)}
    if show_list and name:
        raise UsageError("--list takes no node's name", f"type lcmtools run {name}, or only --list")
    if show_list:
        document(sorted(known)) if as_json else lines(sorted(known))
        return 0
    if not name:
        raise UsageError("the node's name is missing", "lcmtools run --list shows them")
    if name not in known:
        raise UsageError(
            f"there is no node '{name}'",
            did_you_mean(name, known) or "lcmtools run --list shows them",
        )
    program = _load(known[name])
    click.get_current_context().meta[COMMAND] = f"lcmtools run {name}"
    try:
        return program([*_bus_arguments(), *arguments]) or 0
    except KeyboardInterrupt:  # asked to end before the node was ready to be asked
        return 0


def _load(entry: EntryPoint) -> Program:
    try:
        return cast(Program, entry.load())
    except ModuleNotFoundError as error:
        raise MissingExtra(
            f"{entry.name} needs the Python package '{error.name}', which is not installed",
            f"type: pip install {error.name}",
        ) from error


def _bus_arguments() -> list[str]:
    """The bus that was chosen before the command's name, as the node's own arguments."""
    choice = bus_choice()
    return [
        *(["--lcm-url", choice.url] if choice.url else []),
        *(["--domain", choice.domain] if choice.domain else []),
    ]
