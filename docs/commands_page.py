"""The page docs/commands.md, made from the commands: ``make docs`` writes it."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path

import click
from man_pages import Words, arguments, commands, context_of
from ros_equivalents import EQUIVALENTS

from lcmtools.cli.lazy import LazyGroup
from lcmtools.cli.main import EXIT_CODES, root
from lcmtools.settings import SETTINGS, VARIABLES

PAGE = Path(__file__).with_name("commands.md")
_INTRODUCTION = """\
# The commands

<!-- Made by docs/commands_page.py from the commands: change these, and run: make docs -->

`lcmtools COMMAND --help` describes a command with all its options and examples. If lcmtools is
installed from a wheel, or by pip without `-e`, each command has a man page: `man lcmtools-echo`.

The tables leave out the options that many commands share: `--lcm-url` and `--domain` select the
bus, `--ns` and `--remap` the names, as do `__ns:=/x` and `a:=b`; `-b FILE` reads a log instead of
the bus; `--json` prints JSON ([the keys](json.md)); errors are then JSON too, on standard error.

ROS's names of the commands work too: `lcmtools topic list` is `lcmtools list`, and `lcmtools
rosnode` is `lcmtools node`.
"""
_SHARED = {"--json", "--lcm-url", "--domain", "--ns", "--remap", "--bag"}
_MORE: Mapping[str, str] = {
    "bag": "[Recording](recording.md) shows what each does.",
    "gui": "[The window](gui.md) describes the panels.",
    "lab": "The labs: [Husky](../labs/husky/README.md), [Pioneer](../labs/pioneer/README.md), "
    "[Dolly](../labs/dolly/README.md).",
    "msg": "[Own messages](own-messages.md) shows how to write and build types.",
    "pkg": "[Writing nodes](writing-nodes.md#packages-and-launch-files) has an example.",
    "sim": "[The simulator](simulator.md#control) has examples.",
}
"""The pages on groups of commands."""
_END = """\
## Topics, patterns and values

- A topic pattern has one meaning in all commands: `*` matches within one part of a name, `**`
  across parts, `?` one character. Put it in quotes: `lcmtools echo '/*/odometry'`. See
  [how it works](how-it-works.md).
- `pub` takes YAML or JSON; a time may be `now`, a header `auto`.
- `pub` accepts the output of `echo` without loss: `lcmtools echo --json /odom | lcmtools pub
  /odom_copy nav_msgs/Odometry -` is a live relay.
- `delay` takes the time from the header, or from a field such as `utime` or `timestamp`.

## TAB completion

`lcmtools completion --install` installs it for bash, zsh and fish: commands, topics on the bus,
types, fields, nodes, services, and messages to fill in.

## Settings

`lcmtools config` shows each setting and its source: an option, else an environment variable, else
the file `~/.config/lcmtools/config.yaml` (for example `domain: 3`).
"""
_WTF_CODES = """\
`wtf` exits with 0 if it finds nothing, 1 with warnings, 2 with errors, 64 if it cannot run."""


def page() -> str:
    """Return the page: the commands by group, and what holds for all of them."""
    listed = root.list_commands(click.Context(root))
    paths = [words[1:] for words in commands() if words[1:2] and words[1] in listed]
    groups = [path for path in paths if isinstance(_command(path), LazyGroup)]
    rows = [_INTRODUCTION, "## Commands without a group", ""]
    rows += _table([path for path in paths if len(path) == 1 and path not in groups], set())
    for (group,) in groups:
        members = [path for path in paths if len(path) > 1 and path[0] == group]
        common = set.intersection(*(set(_options(path)) for path in members))
        rows += ["", f"## lcmtools {group}", "", _about(group, common), ""]
        rows += _table(members, common)
    rows += ["", _END, "| option or argument | variable | in the file |", "| --- | --- | --- |"]
    rows += [f"| `{one.option}` | `{one.variable}` | `{one.name}` |" for one in SETTINGS.values()]
    rows += ["", "| other variable | meaning |", "| --- | --- |"]
    rows += [f"| `{name}` | {meaning} |" for name, meaning in VARIABLES.items()]
    rows += ["", "## Exit codes", "", " ".join(EXIT_CODES.split()), "", _WTF_CODES]
    return "\n".join(rows) + "\n"


def _command(path: Words) -> click.Command:
    return context_of(("lcmtools", *path)).command


def _about(group: str, common: Collection[str]) -> str:
    """Return a paragraph about a group, with the options that all of its commands have."""
    summary = (_command((group,)).help or "").partition("\n")[0]
    takes = f"Each command also takes {', '.join(map(_code, sorted(common)))}." if common else ""
    return " ".join(part for part in (summary, takes, _MORE.get(group)) if part)


def _table(paths: Sequence[Words], common: Collection[str]) -> Iterator[str]:
    """Yield a table of commands, without the options that are common to them."""
    yield from ("| command | what it does | options | in ROS |", "| --- | --- | --- | --- |")
    for path in paths:
        usage = _code(" ".join(["lcmtools", *path, *arguments(_command(path))]))
        options = " ".join(_code(name) for name in _options(path) if name not in common)
        ros = EQUIVALENTS.get(" ".join(path))
        yield f"| {usage} | {_help_line(path)} | {options} | {_code(ros) if ros else ''} |"


def _help_line(path: Words) -> str:
    """Return a command's line in the help of its group, or of lcmtools."""
    group = _command(path[:-1])
    assert isinstance(group, LazyGroup)
    text = group.all_help_lines()[path[-1]]
    return text[:1].lower() + text[1:]


def _options(path: Words) -> list[str]:
    """Return the options of a command that few others have, each by its longest name."""
    names = [
        [*one.opts, *one.secondary_opts]
        for one in _command(path).params
        if isinstance(one, click.Option) and not one.hidden
    ]
    return [max(those, key=len) for those in names if not _SHARED.intersection(those)]


def _code(text: str) -> str:
    return f"`{text}`".replace("|", "\\|")  # a table's cells end at |


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
