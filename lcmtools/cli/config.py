"""``lcmtools config``."""

import os

import click

from lcmtools.bus.url import choose_url
from lcmtools.cli.options import COLOR, CONTEXT, bus_choice, bus_options, json_option
from lcmtools.cli.output import document, lines
from lcmtools.settings import SETTINGS, Said, UserFile, read_user_file, said


@click.command("config", context_settings=CONTEXT)
@json_option
@bus_options
def command(*, as_json: bool) -> None:
    """Show each setting's value and what says so, and where your settings file is.

    A setting is said by an option, else by an environment variable, else in the file, which is
    YAML with the settings' names as keys. A URL wins over a domain of the same rank.

    \b
    Examples:
      lcmtools config
      lcmtools config --domain 3 --json
    """  # noqa: D301 - \b is click's mark
    file = read_user_file(os.environ)
    choice = bus_choice()
    url, source = choose_url(choice.url, choice.domain, os.environ, file)
    color = click.get_current_context().meta.get(COLOR)
    flags = {"lcm_url": choice.url, "domain": choice.domain, "color": color}
    values = {name: said(name, flags.get(name), os.environ, file) for name in SETTINGS}
    bus = Said(str(url), source)
    if as_json:
        document(_record(file, bus, values))
    else:
        lines(_table(file, bus, values))


def _record(file: UserFile, bus: Said, values: dict[str, Said]) -> dict[str, object]:
    return {
        "file": str(file.path) if file.path else None,
        "file_exists": _exists(file),
        "bus": {"value": bus.value, "source": bus.source},
        "settings": [
            {
                "name": name,
                "value": value.value or None,
                "source": value.source,
                "option": SETTINGS[name].option,
                "variable": SETTINGS[name].variable,
            }
            for name, value in values.items()
        ],
    }


def _table(file: UserFile, bus: Said, values: dict[str, Said]) -> list[str]:
    """One line a setting: name, value, what says so; then the bus that follows, and the file."""
    rows = [(name, value.value or "-", value.source) for name, value in values.items()]
    rows.append(("bus", bus.value, bus.source))
    widths = [max(len(row[column]) for row in rows) for column in (0, 1)]
    table = [f"{name:<{widths[0]}}  {value:<{widths[1]}}  {by}" for name, value, by in rows]
    state = "" if _exists(file) else " (there is none)"
    return [*table, f"file: {file.path or 'no home, no file'}{state}"]


def _exists(file: UserFile) -> bool:
    return file.path is not None and file.path.exists()
