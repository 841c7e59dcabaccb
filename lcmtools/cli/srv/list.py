"""``lcmtools srv list``."""

import click

from lcmtools.cli.options import CONTEXT, json_option
from lcmtools.cli.output import show
from lcmtools.messages.registry import service_names


@click.command("list", context_settings=CONTEXT)
@json_option
def command(*, as_json: bool) -> None:
    """List the service types that lcmtools knows.

    \b
    Examples:
      lcmtools srv list
      lcmtools srv list --json
    """  # noqa: D301 - \b is click's mark
    show(service_names(), service_names(), as_json=as_json)
