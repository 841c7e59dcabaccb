"""``lcmtools config``."""

import os

import click

from lcmtools.bus.url import choose_url
from lcmtools.cli.bus import with_notes
from lcmtools.cli.declare import examples, subcommand
from lcmtools.cli.options import COLOR, bus_choice, bus_options, json_option
from lcmtools.cli.output import write_result
from lcmtools.packages.noted import noted_workspaces
from lcmtools.settings import SETTINGS, VARIABLES, lookup, read_user_file
from lcmtools.text_table import text_table


@subcommand("config", json_option, bus_options)
@examples("config", "config --domain 3 --json")
def command(*, as_json: bool) -> None:
    """Show each setting's value and source, the environment variables, and your settings file.

    A setting is taken from an option, else from an environment variable, else from the file, which
    is YAML with the settings' names as keys. A URL takes precedence over a domain from the same
    source. Workspaces are folders whose packages are found from everywhere; pkg create notes them
    in a file, whose lines can be removed. Variables that other programs use too, such as NO_COLOR,
    are shown if they are set.
    """
    file = read_user_file(os.environ)
    choice = bus_choice()
    url, source = choose_url(choice.url, choice.domain, os.environ, file)
    with_notes(url, source)
    color = click.get_current_context().meta.get(COLOR)
    flags = {"lcm_url": choice.url, "domain": choice.domain, "color": color}
    values = {name: lookup(name, flags.get(name), os.environ, file) for name in SETTINGS}
    noted = noted_workspaces(os.environ)
    variables = {name: os.environ.get(name) or None for name in VARIABLES}
    file_exists = file.path is not None and os.path.exists(file.path)  # noqa: PTH110 - never raises
    record = {
        "file": str(file.path) if file.path else None,
        "file_exists": file_exists,
        "bus": {"value": str(url), "source": source},
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
        "workspaces": {"value": list(map(str, noted.folders)), "source": noted.source or None},
        "variables": [
            {"name": name, "value": variables[name], "meaning": meaning}
            for name, meaning in VARIABLES.items()
        ],
    }
    rows = [(name, value.value or "-", value.source) for name, value in values.items()]
    rows += [
        ("bus", str(url), source),
        (
            "workspaces",
            ":".join(map(str, noted.folders)) or "-",
            noted.source or "no home, no file",
        ),
    ]
    rows += [
        (name, variables[name] or "-", meaning)
        for name, meaning in VARIABLES.items()
        if variables[name] or name.startswith("LCMTOOLS_")
    ]
    table = text_table(rows)
    state = "" if file_exists else " (there is none)"
    place = f"file: {file.path or 'no home, no file'}{state}"
    write_result(record, [*table, place], as_json=as_json)
