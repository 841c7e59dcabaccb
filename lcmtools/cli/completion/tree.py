"""The commands as plain data, for completion without importing click.

A command's description is read once from its click command and kept in a file of the user's
cache, until a file of the command line changes. ``python -m`` and editable installs are no
exception.
"""

import contextlib
import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from lcmtools.cli.completion import Source
from lcmtools.folders import cache_folder, write_atomically

if TYPE_CHECKING:  # click takes longer to import than a completion otherwise takes
    import click

_FORMAT = 4  # of the file
_CODE = ("cli", "doctor", "labs/commands")  # the folders whose files decide on what is kept


class Option(NamedTuple):
    """An option of a command."""

    names: Sequence[str]  # the long form last
    parameter: str  # its name in the command's code
    source: Source | None  # None for a flag
    help: str = ""
    repeats: bool = False
    is_hidden: bool = False  # understood, but not offered


class Argument(NamedTuple):
    """An argument of a command; if it repeats, it takes all words that follow."""

    parameter: str
    source: Source
    repeats: bool = False


class Command(NamedTuple):
    """The options and arguments of a command, or the commands of a group."""

    options: Sequence[Option]
    arguments: Sequence[Argument]
    commands: Mapping[str, str]  # and their descriptions; aliases too
    is_mixed: bool = True  # its own options may stand behind the first argument


class Tree:
    """All commands, kept in the cache folder of the environment."""

    def __init__(self, environment: Mapping[str, str]) -> None:
        folder = cache_folder(environment)
        self._file = folder / "commands.json" if folder else None
        self._kept = _read(self._file)
        self._is_new = False

    def describe(self, path: Sequence[str]) -> Command | None:
        """Return the command with these words; None where there is none."""
        key = " ".join(path)
        if key in self._kept:
            with contextlib.suppress(ValueError, TypeError):
                options, arguments, commands, is_mixed = self._kept[key]
                return Command(
                    [Option(*option) for option in options],
                    [Argument(*argument) for argument in arguments],
                    dict(commands),
                    is_mixed,
                )
        command = _from_click(path)
        if command is not None:
            self._kept[key] = command
            self._is_new = True
        return command

    def prepare(self) -> None:
        """Keep all commands, so that the first completion of each is fast too."""
        waiting: list[list[str]] = [[]]
        while waiting:
            path = waiting.pop()
            with contextlib.suppress(ImportError):  # a command that needs what is not installed
                if command := self.describe(path):
                    waiting += [[*path, name] for name in command.commands]
        self.keep()

    def keep(self) -> None:
        """Write the commands read from click to the cache; a full disk does not matter."""
        if self._is_new and self._file:
            with contextlib.suppress(OSError):
                self._file.parent.mkdir(parents=True, exist_ok=True)
                text = json.dumps({"stamp": _stamp(), "commands": self._kept})
                write_atomically(self._file, text)


def _read(file: Path | None) -> dict[str, Any]:
    try:
        kept = json.loads(file.read_text(encoding="utf-8")) if file else {}
        return dict(kept["commands"]) if kept["stamp"] == _stamp() else {}
    except (OSError, ValueError, KeyError, TypeError):
        return {}


def _stamp() -> list[object]:
    """A value that changes with the files that decide on what is kept."""
    folders = [str(Path(__file__).parents[2] / folder) for folder in _CODE]
    times = [0]
    for folder in folders:
        for entry in os.scandir(folder):
            if entry.is_dir():
                folders.append(entry.path)
            elif entry.name.endswith(".py"):
                times.append(entry.stat().st_mtime_ns)
    return [_FORMAT, __file__, len(times), max(times)]


def _from_click(path: Sequence[str]) -> Command | None:
    import click

    from lcmtools.cli.lazy import LazyGroup
    from lcmtools.cli.main import root

    command: click.Command | None = root
    context = click.Context(root, info_name="lcmtools")
    for word in path:
        if not isinstance(command, click.Group):
            return None
        command = command.get_command(context, word)
    if command is None:
        return None
    # click keeps a command's help option as the first context has it
    parameters = command.get_params(click.Context(command, **command.context_settings))
    arguments = [one for one in parameters if isinstance(one, click.Argument)]
    said = command.context_settings
    takes_others = said.get("ignore_unknown_options", command.ignore_unknown_options)
    is_mixed = said.get("allow_interspersed_args", command.allow_interspersed_args)
    return Command(
        [_option(one) for one in parameters if isinstance(one, click.Option)],
        [Argument(str(one.name), _source(one), one.nargs == -1) for one in arguments],
        command.all_help_lines() if isinstance(command, LazyGroup) else {},
        bool(is_mixed and not takes_others),
    )


def _option(option: "click.Option") -> Option:
    return Option(
        sorted((*option.opts, *option.secondary_opts), key=len),
        str(option.name),
        None if option.is_flag or option.count else _source(option),
        (option.help or "").partition(". ")[0].rstrip("."),
        option.multiple,
        option.hidden,
    )


def _source(parameter: "click.Parameter") -> Source:
    """The candidates' source: as declared, else by the parameter's click type."""
    import click

    declared: Source = getattr(parameter, "completer", "")
    if isinstance(parameter.type, click.Choice):
        declared = list(map(str, parameter.type.choices))
    if not isinstance(declared, str):
        return [[one] if isinstance(one, str) else [*one] for one in declared]
    if declared:
        return declared
    is_file = isinstance(parameter.type, (click.Path, click.File))
    return "files" if is_file else ""
