"""The commands as plain data, for completion without importing click.

A command's description is read once from its click command and kept in a file of the user's
cache, until a file of the command line changes. ``python -m`` and editable installs are no
exception.
"""

import contextlib
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from lcmtools.cli.completion.completer import Completer, Source
from lcmtools.cli.files import cache_folder, write_atomically

if TYPE_CHECKING:  # click takes longer to import than a completion otherwise takes
    import click

_FORMAT = 3  # of the file
_CODE = ("cli", "doctor", "labs/commands")
"""The folders whose files decide on what is kept."""


@dataclass(frozen=True, slots=True)
class Option:
    """An option of a command.

    Attributes:
        names: Its spellings, the long form last.
        parameter: The parameter's name in the command's code.
        source: Where its values come from; None for a flag.
        help: A description.
        repeats: True if it may be given again.
        is_hidden: True if it is understood, but not offered.
    """

    names: Sequence[str]
    parameter: str
    source: Source | None
    help: str = ""
    repeats: bool = False
    is_hidden: bool = False


@dataclass(frozen=True, slots=True)
class Argument:
    """An argument of a command; if it repeats, it takes all words that follow."""

    parameter: str
    source: Source
    repeats: bool = False


@dataclass(frozen=True, slots=True)
class Command:
    """The options and arguments of a command.

    Attributes:
        options: Its options.
        arguments: Its arguments in order.
        commands: The commands of a group, aliases too, with their descriptions.
        is_mixed: True if its own options may stand behind the first argument.
    """

    options: Sequence[Option]
    arguments: Sequence[Argument]
    commands: Mapping[str, str]
    is_mixed: bool = True


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
            with contextlib.suppress(ImportError):  # a command that needs what is not installed
                if command := self.describe(path):
                    waiting += [[*path, name] for name in command.commands]

    def keep(self) -> None:
        """Write the commands read from click to the cache; a full disk does not matter."""
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
    """A value that changes with the files that decide on what is kept."""
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
    said = command.context_settings
    takes_others = said.get("ignore_unknown_options", command.ignore_unknown_options)
    is_mixed = said.get("allow_interspersed_args", command.allow_interspersed_args)
    return Command(
        [_option(one) for one in parameters if isinstance(one, click.Option)],
        [
            Argument(str(one.name), _source(one), one.nargs == -1)
            for one in parameters
            if isinstance(one, click.Argument)
        ],
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

    declared = parameter._custom_shell_complete  # noqa: SLF001 - click can only call it
    if isinstance(declared, Completer):
        return declared.source()
    if isinstance(parameter.type, click.Choice):
        return [[str(choice)] for choice in parameter.type.choices]
    is_file = isinstance(parameter.type, (click.Path, click.File))
    return "files" if is_file else ""


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
