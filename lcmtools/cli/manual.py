"""The man pages, made from what the commands say of themselves.

``python -m lcmtools.cli.manual docs/man`` writes them, ``--check`` only says which are stale. They
are committed, so that building lcmtools needs nothing of it, and a test proves them fresh.
How a page looks is decided here; what it says is in the commands' help.
"""

import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import click

from lcmtools import __version__
from lcmtools.cli.lazy import LazyGroup
from lcmtools.cli.main import root
from lcmtools.cli.output import lines
from lcmtools.settings import SETTINGS

Words = tuple[str, ...]

_ENVIRONMENT = {
    **{setting.variable: setting.option for setting in SETTINGS.values()},
    "LCMTOOLS_DEBUG": "--debug",
    "NO_COLOR": "--color=never",
    "FORCE_COLOR": "--color=always",
}


def commands(command: click.Command = root, words: Words = ("lcmtools",)) -> Iterator[Words]:
    """The words of every command that has a page: second names of one that has it are left out."""
    yield words
    if isinstance(command, LazyGroup):
        context = click.Context(command)
        for name in command.with_pages():
            below = command.get_command(context, name)
            assert below is not None
            yield from commands(below, (*words, name))


def page(words: Words) -> str:
    """The man page of a command, in roff's man macros."""
    context = _context(words)
    command = context.command
    paragraphs = _paragraphs(command)
    summary = _summary(context)
    rows = [
        f'.TH "{_escaped("-".join(words)).upper()}" "1" "" "lcmtools {__version__}" "lcmtools"',
        ".SH NAME",
        f"{_escaped('-'.join(words))} \\- {_escaped(summary[:1].lower() + summary[1:])}",
        ".SH SYNOPSIS",
        f".B {_escaped(' '.join(words))}",
        _escaped(" ".join(_synopsis(command))),
        ".SH DESCRIPTION",
        *_description(paragraphs),
        *_options(context),
    ]
    if isinstance(command, LazyGroup):
        rows += [".SH COMMANDS", *_below(command, words)]
    return "\n".join([*rows, *_surroundings(), *_see_also(words)]) + "\n"


def stale(folder: Path) -> dict[Path, str | None]:
    """The pages that are not what they should be, with their text; None for a stray one."""
    wanted = {folder / f"{'-'.join(words)}.1": page(words) for words in commands()}
    strays: dict[Path, str | None] = dict.fromkeys(set(folder.glob("*.1")) - set(wanted))
    different = {
        path: text
        for path, text in wanted.items()
        if not path.exists() or path.read_text("utf-8") != text
    }
    return {**strays, **different}


def main(arguments: Sequence[str]) -> int:
    """Write the pages into a folder; with ``--check`` only say which are stale."""
    folder = Path(next(word for word in arguments if not word.startswith("-")))
    changes = stale(folder)
    lines(f"stale: {path}" for path in sorted(changes))
    if "--check" in arguments:
        return 1 if changes else 0
    folder.mkdir(parents=True, exist_ok=True)
    for path, text in changes.items():
        if text is None:
            path.unlink()
        else:
            path.write_text(text, "utf-8")
    return 0


def _context(words: Words) -> click.Context:
    """The click context that these words lead to."""
    context = click.Context(root, info_name=words[0])
    for word in words[1:]:
        assert isinstance(context.command, click.Group)
        below = context.command.get_command(context, word)
        assert below is not None
        context = click.Context(below, info_name=word, parent=context)
    return context


def _summary(context: click.Context) -> str:
    """One line on what the command does, for NAME."""
    above = context.parent.command if context.parent else None
    listed = dict(above.help_lines()) if isinstance(above, LazyGroup) else {}
    text = listed.get(context.info_name or "") or context.command.get_short_help_str(100)
    return text.rstrip(".")


def _paragraphs(command: click.Command) -> list[list[str]]:
    """The help's paragraphs as lines; click's mark is first where lines are to stay as they are."""
    text = "\n\n".join(part for part in (command.help, command.epilog) if part)
    return [paragraph.split("\n") for paragraph in re.split(r"\n\s*\n", text.strip())]


def _description(paragraphs: Sequence[Sequence[str]]) -> Iterator[str]:
    for number, (first, *rest) in enumerate(paragraphs):
        if first.strip() != "\b":
            yield from ([".PP"] if number else [])
            yield from (_escaped(row.strip()) for row in (first, *rest))
        elif rest[0].strip() == "Examples:":
            yield ".SH EXAMPLES"
            yield from _verbatim(rest[1:])
        else:
            yield ".PP"
            yield from _verbatim(rest)


def _verbatim(rows: Sequence[str]) -> list[str]:
    return [".nf", *(_escaped(row.strip()) for row in rows), ".fi"]


def _synopsis(command: click.Command) -> Iterator[str]:
    yield "[OPTIONS]"
    for parameter in command.params:
        if isinstance(parameter, click.Argument):
            yield _argument(parameter)
    if isinstance(command, click.Group):
        yield "COMMAND [ARGS...]"


def _argument(argument: click.Argument) -> str:
    """As "TOPIC", "[TYPE]" or "NODE...", whatever click's version makes of it."""
    name = argument.metavar or str(argument.name).upper()
    many = "..." if argument.nargs == -1 and not name.endswith(("...", "...]")) else ""
    return f"{name}{many}" if argument.required or name.startswith("[") else f"[{name}{many}]"


def _options(context: click.Context) -> Iterator[str]:
    yield ".SH OPTIONS"
    for option in context.command.params:
        if isinstance(option, click.Option) and not option.hidden:
            names = ", ".join([*option.opts, *option.secondary_opts])
            value = option.metavar or option.type.name.upper()
            yield from (".TP", f".B {_escaped(names)}{'' if option.is_flag else f' {value}'}")
            yield _escaped(" ".join((option.help or "").split()))
    yield from (".TP", f".B {_escaped('-h, --help')}", "Show the help and exit.")


def _below(group: LazyGroup, words: Words) -> Iterator[str]:
    for name, text in group.help_lines():
        yield from (".TP", f".BR {_escaped('-'.join((*words, name)))} (1)", _escaped(text))


def _surroundings() -> Iterator[str]:
    """What is true of every command."""
    yield from (".SH EXIT STATUS", _escaped(EXIT_CODES))
    yield ".SH ENVIRONMENT"
    for variable, option in _ENVIRONMENT.items():
        yield from (".TP", f".B {variable}", f"As {_escaped(option)}; an option wins over it.")
    yield from (".SH FILES", ".TP", ".I $XDG_CONFIG_HOME/lcmtools/config.yaml")
    yield f"Settings where neither option nor variable says else: {', '.join(SETTINGS)}."


def _see_also(words: Words) -> list[str]:
    above = "lcmtools-config" if len(words) == 1 else "-".join(words[:-1])
    return [".SH SEE ALSO", f".BR {_escaped(above)} (1)"]


EXIT_CODES = (
    "0 done, 1 failed, 2 wrong usage, 3 an extra is missing, 4 nothing came within --timeout,"
    " 130 Ctrl-C, 143 SIGTERM. A node that is asked to end exits with 0."
)


def _escaped(text: str) -> str:
    """Text as roff shows it to the letter: hyphens stay hyphens, no line is a macro."""
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq").replace("`", "\\(ga")
    text = text.replace("^", "\\(ha").replace("~", "\\(ti").replace('"', "\\(dq")
    return f"\\&{text}" if text.startswith(".") else text


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
