"""Command groups whose commands are imported only when they run.

``lcmtools --help`` must not pay for what every command needs; so a group is a table of names, help
lines and homes.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import cast

import click

from lcmtools.names import closest


@dataclass(frozen=True, slots=True)
class Entry:
    """A command of a group.

    Attributes:
        home: "module:attribute" of the click command.
        help: One line for the group's help.
        is_alias: Left out of the group's help: a second name of a command that is listed.
    """

    home: str
    help: str
    is_alias: bool = False


class LazyGroup(click.Group):
    """A group that knows its commands by a table."""

    def __init__(self, *args: object, entries: Mapping[str, Entry], **kwargs: object) -> None:
        super().__init__(*args, **kwargs)  # type: ignore[arg-type] # click's own arguments
        self._entries = entries

    def list_commands(self, ctx: click.Context) -> list[str]:
        """The commands that help lists."""
        del ctx
        return [name for name, entry in self._entries.items() if not entry.is_alias]

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import one command; None when there is none of this name."""
        del ctx
        entry = self._entries.get(cmd_name)
        if entry is None:
            return None
        module, _, attribute = entry.home.partition(":")
        return cast(click.Command, getattr(import_module(module), attribute))

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command, or say which one may have been meant."""
        name = args[0]
        if self.get_command(ctx, name) is None and not name.startswith("-"):
            near = closest(name, self._entries)
            hint = f"; did you mean '{near[0]}'?" if near else ""
            ctx.fail(f"no such command '{name}'{hint}")
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """List the commands from the table, importing none."""
        rows = [(name, self._entries[name].help) for name in self.list_commands(ctx)]
        with formatter.section("Commands"):
            formatter.write_dl(rows)
