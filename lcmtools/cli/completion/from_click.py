"""The commands of click as plain data: ``python -m lcmtools.cli.completion.from_click``.

Belongs here: writing the file that ``tree`` reads. A completion has no time for it.
"""

import json
from collections.abc import Iterator, Sequence

import click

from lcmtools.cli.completion import Source
from lcmtools.cli.completion.tree import FILE, Argument, Command, Option
from lcmtools.cli.lazy import LazyGroup
from lcmtools.cli.main import root


def text() -> str:
    """Return the text of the file, a line for each command."""
    return "".join(f"{json.dumps(row, separators=(',', ':'))}\n" for row in _rows([]))


def _rows(path: Sequence[str]) -> Iterator[list[object]]:
    described = _described(path)
    yield [" ".join(path), *described]
    for name in described.commands:
        yield from _rows([*path, name])


def _described(path: Sequence[str]) -> Command:
    command: click.Command | None = root
    context = click.Context(root, info_name="lcmtools")
    for word in path:
        assert isinstance(command, click.Group)
        command = command.get_command(context, word)
    assert command is not None
    # click keeps a command's help option as the first context has it
    parameters = command.get_params(click.Context(command, **command.context_settings))
    arguments = [one for one in parameters if isinstance(one, click.Argument)]
    settings = command.context_settings
    takes_others = settings.get("ignore_unknown_options", command.ignore_unknown_options)
    is_mixed = settings.get("allow_interspersed_args", command.allow_interspersed_args)
    return Command(
        [_option(one) for one in parameters if isinstance(one, click.Option)],
        [Argument(str(one.name), _source(one), one.nargs == -1) for one in arguments],
        command.all_help_lines() if isinstance(command, LazyGroup) else {},
        bool(is_mixed and not takes_others),
    )


def _option(option: click.Option) -> Option:
    return Option(
        sorted((*option.opts, *option.secondary_opts), key=len),
        str(option.name).removeprefix("_click_default_"),  # as older versions name that of help
        None if option.is_flag or option.count else _source(option),
        (option.help or "").partition(". ")[0].rstrip("."),
        option.multiple,
        option.hidden,
    )


def _source(parameter: click.Parameter) -> Source:
    """Return the declared source of candidates, or else that of the parameter's click type."""
    declared: Source = getattr(parameter, "completer", "")
    if isinstance(parameter.type, click.Choice):
        declared = list(map(str, parameter.type.choices))
    if not isinstance(declared, str):
        return [[one] if isinstance(one, str) else [*one] for one in declared]
    if declared:
        return declared
    is_file = isinstance(parameter.type, (click.Path, click.File))
    return "files" if is_file else ""


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
