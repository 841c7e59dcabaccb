"""``lcmtools service find``."""

import click

from lcmtools.cli.completion.completer import complete
from lcmtools.cli.options import CONTEXT, all_option, json_option, looking_options, open_monitor
from lcmtools.cli.output import document, lines, talk
from lcmtools.messages.registry import service_name
from lcmtools.observe.services import offered_services


@click.command("find", context_settings=CONTEXT)
@click.argument("type_", metavar="TYPE", shell_complete=complete("messages:service_types"))
@all_option
@json_option
@looking_options
def command(type_: str, *, show_all: bool, as_json: bool) -> None:
    """List the services of a type.

    TYPE is std_srvs/Trigger, std_srvs/srv/Trigger, std_srvs.Trigger or Trigger.

    \b
    Examples:
      lcmtools service find std_srvs/Trigger
      lcmtools service find SetBool --json
    """  # noqa: D301 - \b is click's mark
    name = service_name(type_)
    with open_monitor("service_find") as monitor:
        graph, url = monitor.settle(foreign=False), monitor.url
    found = [s.name for s in offered_services(graph, show_all=show_all) if name in s.types]
    document(found) if as_json else lines(found)
    if not found:
        talk(f"no services of type {name} on {url}")
