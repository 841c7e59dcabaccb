"""``lcmtools pkg find``."""

import click

from lcmtools.cli.completion.completer import complete
from lcmtools.cli.options import CONTEXT, json_option
from lcmtools.cli.output import document, lines
from lcmtools.cli.pkg.found import folders, unknown


@click.command("find", context_settings=CONTEXT)
@click.argument("name", shell_complete=complete("programs:packages"))
@json_option
def command(name: str, *, as_json: bool) -> None:
    """Print the folder of a package.

    \b
    Examples:
      lcmtools pkg find air_lab0
      lcmtools pkg prefix air_lab0 --json
    """  # noqa: D301 - \b is click's mark
    found = folders()
    if name not in found:
        raise unknown(name, list(found))
    folder, is_installed = found[name]
    if as_json:
        document({"name": name, "folder": str(folder), "is_installed": is_installed})
    else:
        lines([str(folder)])
