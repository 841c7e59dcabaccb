"""The man pages, made from the commands' own help.

``python docs/man_pages.py FOLDER`` writes them; building a wheel does so (hatch_build.py).
"""

import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import click

from lcmtools import __version__
from lcmtools.cli.lazy import LazyGroup
from lcmtools.cli.main import EXIT_CODES, root
from lcmtools.settings import SETTINGS, VARIABLES

Words = tuple[str, ...]

_ENVIRONMENT = {
    **{one.variable: f"As {one.option}; an option wins over it." for one in SETTINGS.values()},
    **{name: f"{text[0].upper()}{text[1:]}." for name, text in VARIABLES.items()},
}


def commands(command: click.Command = root, words: Words = ("lcmtools",)) -> Iterator[Words]:
    """Yield the words of every command that has a page; aliases of such a one have none."""
    yield words
    if isinstance(command, LazyGroup):
        context = click.Context(command)
        for name in command.with_pages():
            below = command.get_command(context, name)
            assert below is not None
            yield from commands(below, (*words, name))


def page(words: Words) -> str:
    """Return the man page of a command, in roff's man macros."""
    context = context_of(words)
    command, name = context.command, _escaped("-".join(words))
    summary = _summary(context)
    rows = [
        f'.TH "{name.upper()}" "1" "" "lcmtools {__version__}" "lcmtools"',
        *(".SH NAME", f"{name} \\- {_escaped(summary[:1].lower() + summary[1:])}"),
        *(".SH SYNOPSIS", f".B {_escaped(' '.join(words))}"),
        _escaped(" ".join(_synopsis(command))),
        *(".SH DESCRIPTION", *_description(command)),
        *(".SH OPTIONS", *_options(command)),
    ]
    if isinstance(command, LazyGroup):
        rows.append(".SH COMMANDS")
        for below, text in command.help_lines():
            rows += [".TP", f".BR {_escaped('-'.join((*words, below)))} (1)", _escaped(text)]
    rows += [".SH EXIT STATUS", _escaped(" ".join(EXIT_CODES.split())), ".SH ENVIRONMENT"]
    for variable, text in _ENVIRONMENT.items():
        rows += [".TP", f".B {variable}", _escaped(text)]
    above = "lcmtools-config" if len(words) == 1 else "-".join(words[:-1])
    rows += [
        *(".SH FILES", ".TP", ".I $XDG_CONFIG_HOME/lcmtools/config.yaml"),
        f"Settings, unless an option or a variable is set: {', '.join(SETTINGS)}.",
        *(".SH SEE ALSO", f".BR {_escaped(above)} (1)"),
    ]
    return "\n".join(rows) + "\n"


def write_pages(folder: Path) -> None:
    """Write the page of every command into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for words in commands():
        (folder / f"{'-'.join(words)}.1").write_text(page(words), "utf-8")


def context_of(words: Words) -> click.Context:
    """Return the click context that these words lead to."""
    context = click.Context(root, info_name=words[0])
    for word in words[1:]:
        assert isinstance(context.command, click.Group)
        below = context.command.get_command(context, word)
        assert below is not None
        context = click.Context(below, info_name=word, parent=context)
    return context


def _summary(context: click.Context) -> str:
    above = context.parent.command if context.parent else None
    listed = dict(above.help_lines()) if isinstance(above, LazyGroup) else {}
    text = listed.get(context.info_name or "") or context.command.get_short_help_str(100)
    return text.rstrip(".")


def _description(command: click.Command) -> Iterator[str]:
    """The help's paragraphs; click's mark is before lines that stay as they are."""
    text = "\n\n".join(part for part in (command.help, command.epilog) if part)
    for number, paragraph in enumerate(re.split(r"\n\s*\n", text.strip())):
        first, *rest = (row.strip() for row in paragraph.split("\n"))
        if first != "\b":
            yield from ([".PP"] if number else [])
            yield from map(_escaped, (first, *rest))
        else:
            is_example = rest[0] == "Examples:"
            yield ".SH EXAMPLES" if is_example else ".PP"
            yield from (".nf", *map(_escaped, rest[is_example:]), ".fi")


def _synopsis(command: click.Command) -> Iterator[str]:
    yield "[OPTIONS]"
    yield from arguments(command)
    if isinstance(command, click.Group):
        yield "COMMAND [ARGS...]"


def arguments(command: click.Command) -> Iterator[str]:
    """Yield arguments as "TOPIC", "[TYPE]" or "NODE...", whatever click's version makes of them."""
    for one in command.params:
        if isinstance(one, click.Argument):
            name = one.metavar or str(one.name).upper()
            is_all = " " in name  # it has the words of several arguments
            many = "..." if one.nargs == -1 and not is_all and "..." not in name else ""
            is_whole = one.required or is_all or name.startswith("[")
            yield f"{name}{many}" if is_whole else f"[{name}{many}]"


def _options(command: click.Command) -> Iterator[str]:
    for option in command.params:
        if isinstance(option, click.Option) and not option.hidden:
            names = ", ".join([*option.opts, *option.secondary_opts])
            value = "" if option.is_flag else f" {option.metavar or option.type.name.upper()}"
            yield from (".TP", f".B {_escaped(names)}{value}")
            yield _escaped(" ".join((option.help or "").split()))
    yield from (".TP", f".B {_escaped('-h, --help')}", "Show the help and exit.")


def _escaped(text: str) -> str:
    """Text as roff shows it to the letter: hyphens stay hyphens, no line is a macro."""
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq").replace("`", "\\(ga")
    text = text.replace("^", "\\(ha").replace("~", "\\(ti").replace('"', "\\(dq")
    return f"\\&{text}" if text.startswith(".") else text


def main(arguments: Sequence[str]) -> None:
    """Write the pages into the folder that is named."""
    (folder,) = arguments
    write_pages(Path(folder))


if __name__ == "__main__":
    main(sys.argv[1:])
