"""Command groups whose commands are imported only when they run.

``lcmtools --help`` is fast because a group is a table of names, help lines and homes.
"""

import os
from collections.abc import Mapping
from importlib import import_module
from typing import NamedTuple, cast

import click

from lcmtools.cli.options import extract_names, is_looking, manner_options
from lcmtools.cli.output import write_note
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.names import closest
from lcmtools.settings import SETTINGS, read_user_file

COMMAND = "lcmtools.command"
"""The key of a click context's ``meta`` for the command that is run: "lcmtools list"."""


class Entry(NamedTuple):
    """A command of a group."""

    home: str  # "module:attribute" of the click command, below lcmtools
    help: str  # one line for the group's help, which leaves out aliases
    is_alias: bool = False


class LazyGroup(click.Group):
    """A group with a table of commands."""

    def __init__(self, *args: object, entries: Mapping[str, Entry], **kwargs: object) -> None:
        super().__init__(*args, **kwargs)  # type: ignore[arg-type] # click's own arguments
        self._entries = entries

    def list_commands(self, _: click.Context) -> list[str]:
        """Return the commands that help lists."""
        return [name for name, _ in self.help_lines()]

    def get_command(self, _: click.Context, cmd_name: str) -> click.Command | None:
        """Import a command. Return None if there is none of this name."""
        entry = self._entries.get(cmd_name)
        if entry is None:
            return None
        module, attribute = entry.home.split(":")
        return _mannered(
            cast(click.Command, getattr(import_module(f"lcmtools.{module}"), attribute))
        )

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the group's own options. Without any arguments, print the help."""
        if not args and not ctx.resilient_parsing:
            for line in ctx.get_help().split("\n"):
                write_note(line)
            ctx.exit(UsageError.exit_code)
        return super().parse_args(ctx, args)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command, or fail with the most similar one."""
        command = self.get_command(ctx, args[0])
        if command is None and not args[0].startswith("-"):
            args = self._instead(ctx, args)
            command = self.get_command(ctx, args[0])
        name = args[0]
        ctx.meta[COMMAND] = f"{ctx.command_path} {name}"
        if command is not None:
            ctx.default_map = {name: _usual_values(command)}
            if is_looking(command):
                return name, command, extract_names(ctx, args[1:])
        return super().resolve_command(ctx, args)

    def _instead(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Return the words that replace a command of ROS. Fail for any other unknown command."""
        from lcmtools.cli.ros import instead

        ctx.meta[COMMAND] = ctx.command_path
        found = instead("" if ctx.parent is None else str(self.name), args)
        if not found:
            near = closest(args[0], self._entries)
            hint = f"; did you mean '{near[0]}'?" if near else ""
            ctx.fail(f"no such command '{args[0]}'{hint}")
        return found

    def format_commands(self, _: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands from the table, without imports."""
        with formatter.section("Commands"):
            formatter.write_dl(self.help_lines())

    def help_lines(self) -> list[tuple[str, str]]:
        """Return the commands that the help lists, with their help lines."""
        return [(name, entry.help) for name, entry in self._entries.items() if not entry.is_alias]

    def all_help_lines(self) -> dict[str, str]:
        """Return all commands, including aliases, with their help lines."""
        return {name: entry.help.rstrip(".") for name, entry in self._entries.items()}

    def with_pages(self) -> list[str]:
        """Return the commands that are not aliases of another one in this group."""
        listed = dict(self.help_lines())
        homes = {self._entries[name].home for name in listed}
        return [n for n, entry in self._entries.items() if n in listed or entry.home not in homes]


class WindowGroup(LazyGroup):
    """A group that opens all panels if none is named."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the group's own options. Those of "all" may be given without a panel's name."""
        every = self.get_command(ctx, "all")
        names = [one.opts + one.secondary_opts for one in every.params] if every else []
        known = [name for those in names for name in those]
        stands_alone = not args or args[0].partition("=")[0] in known
        named = stands_alone and not ctx.resilient_parsing
        return super().parse_args(ctx, ["all", *args] if named else args)


def _mannered(command: click.Command) -> click.Command:
    """Add the common options to a command, and the environment variable to its --timeout."""
    known = {option for parameter in command.params for option in parameter.opts}
    for option in manner_options(hidden=True):
        if not known.intersection(option.opts):
            command.params.append(option)
    for parameter in command.params:
        if parameter.name == "timeout" and isinstance(parameter, click.Option):
            parameter.envvar = SETTINGS["timeout"].variable
    return command


def _usual_values(command: click.Command) -> dict[str, str]:
    if not any(parameter.name == "timeout" for parameter in command.params):
        return {}
    try:
        file = read_user_file(os.environ)
    except LcmtoolsError:  # a broken file never stops --help; choosing a bus reports it
        return {}
    return {"timeout": file.values["timeout"]} if "timeout" in file.values else {}
