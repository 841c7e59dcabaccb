"""The commands as plain data: what completion must know of them, without importing click.

What a command takes is read once from its click command and kept in a file of the user's cache,
until a file of the command line changes. ``python -m`` and editable installs are no exception.
"""

import contextlib
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from lcmtools.cli.completion.places import cache_folder, write_atomically

if TYPE_CHECKING:  # click takes longer to import than a completion otherwise takes
    import click

_FORMAT = 2  # of the file
_CODE = ("cli", "doctor/rules")
"""The folders whose files say what is kept."""


@dataclass(frozen=True, slots=True)
class Option:
    """An option of a command.

    Attributes:
        names: How it is written, the long form last.
        parameter: The parameter's name in the command's code.
        kind: What its value is (see ``words.table``); "" for any, None where it takes none.
        help: What it does.
        repeats: Whether it may be given again.
        is_hidden: It is understood, but not offered.
    """

    names: Sequence[str]
    parameter: str
    kind: str | None
    help: str
    repeats: bool
    is_hidden: bool


@dataclass(frozen=True, slots=True)
class Argument:
    """An argument of a command.

    Attributes:
        parameter: The parameter's name in the command's code.
        kind: What it is (see ``words.table``); "" for anything.
        repeats: Whether all words that follow are this argument too.
    """

    parameter: str
    kind: str
    repeats: bool


@dataclass(frozen=True, slots=True)
class Command:
    """What a command takes.

    Attributes:
        options: Its options.
        arguments: Its arguments in order.
        commands: Of a group: names, aliases too, and what each does.
        is_mixed: Its own options may stand behind the first argument; else they are of another.
    """

    options: Sequence[Option]
    arguments: Sequence[Argument]
    commands: Mapping[str, str]
    is_mixed: bool = True


class Tree:
    """All commands.

    Args:
        environment: Where the cache folder is looked up.
    """

    def __init__(self, environment: Mapping[str, str]) -> None:
        folder = cache_folder(environment)
        self._file = folder / "commands.json" if folder else None
        self._kept = _read(self._file)
        self._is_new = False

    def describe(self, path: Sequence[str]) -> Command | None:
        """What the command takes whose words these are; None where there is no such command."""
        key = " ".join(path)
        if key in self._kept:
            with contextlib.suppress(KeyError, TypeError, AttributeError):
                return _from_plain(self._kept[key])
        command = _from_click(path)
        if command is not None:
            self._kept[key] = asdict(command)
            self._is_new = True
        return command

    def describe_all(self) -> None:
        """Read all commands, so that the first completion of each is fast too."""
        waiting: list[list[str]] = [[]]
        while waiting:
            path = waiting.pop()
            command = None
            with contextlib.suppress(ImportError):  # a command that needs what is not installed
                command = self.describe(path)
            if command is not None:
                waiting += [[*path, name] for name in command.commands]

    def keep(self) -> None:
        """Write what was read from click to the cache; a full disk is no matter."""
        if self._is_new and self._file:
            with contextlib.suppress(OSError):
                self._file.parent.mkdir(parents=True, exist_ok=True)
                text = json.dumps({"stamp": _stamp(), "commands": self._kept})
                write_atomically(self._file, text)


def _read(file: Path | None) -> dict[str, object]:
    if file is None:
        return {}
    try:
        kept = json.loads(file.read_text(encoding="utf-8"))
        commands = kept["commands"] if kept["stamp"] == _stamp() else {}
    except (OSError, ValueError, KeyError, TypeError):
        return {}
    return commands if isinstance(commands, dict) else {}


def _stamp() -> list[object]:
    """What changes whenever a file does that says what is kept."""
    folders = [str(Path(__file__).parents[2] / folder) for folder in _CODE]
    newest = count = 0
    while folders:
        for entry in os.scandir(folders.pop()):
            if entry.is_dir():
                folders.append(entry.path)
            elif entry.name.endswith(".py"):
                count += 1
                newest = max(newest, entry.stat().st_mtime_ns)
    return [_FORMAT, str(Path(__file__)), count, newest]


def _from_click(path: Sequence[str]) -> Command | None:
    """Import the command and read what it takes."""
    import click

    from lcmtools.cli.main import root

    command: click.Command | None = root
    context = click.Context(root, info_name="lcmtools")
    for word in path:
        if not isinstance(command, click.Group):
            return None
        command = command.get_command(context, word)
    return None if command is None else _described(command, context, path)


def _described(command: "click.Command", context: "click.Context", path: Sequence[str]) -> Command:
    import click

    from lcmtools.cli.completion.words.table import kind_of

    options, arguments = [], []
    for parameter in command.get_params(context):
        kind, name = kind_of(parameter, path), str(parameter.name)
        if isinstance(parameter, click.Option):
            options.append(_option(parameter, kind))
        else:
            arguments.append(Argument(name, kind, parameter.nargs == -1))
    return Command(options, arguments, _commands(command), _is_mixed(command))


def _is_mixed(command: "click.Command") -> bool:
    """Whether options behind the first argument are the command's own, and all of them."""
    said = command.context_settings
    takes_others = said.get("ignore_unknown_options", command.ignore_unknown_options)
    return bool(
        said.get("allow_interspersed_args", command.allow_interspersed_args) and not takes_others
    )


def _option(option: "click.Option", kind: str) -> Option:
    takes_none = option.is_flag or option.count
    return Option(
        sorted((*option.opts, *option.secondary_opts), key=len),
        str(option.name),
        None if takes_none else kind,
        (option.help or "").partition(". ")[0].rstrip("."),
        option.multiple,
        option.hidden,
    )


def _commands(command: "click.Command") -> dict[str, str]:
    """The commands of a group, aliases too; none of what is no group."""
    from lcmtools.cli.lazy import LazyGroup

    if not isinstance(command, LazyGroup):
        return {}
    entries = command._entries  # noqa: SLF001 - help leaves the aliases out
    return {name: entry.help.rstrip(".") for name, entry in entries.items()}


def _from_plain(plain: object) -> Command:
    """A command as it was kept.

    Raises:
        KeyError, TypeError, AttributeError: It is none.
    """
    assert isinstance(plain, dict)
    return Command(
        [Option(**option) for option in plain["options"]],
        [Argument(**argument) for argument in plain["arguments"]],
        dict(plain["commands"]),
        plain["is_mixed"],
    )
