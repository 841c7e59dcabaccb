"""``lcmtools srv list`` and ``show``."""

from lcmtools.cli.declare import argument, option, subcommand
from lcmtools.cli.options import json_option
from lcmtools.cli.output import show
from lcmtools.messages.registry import service_class, service_name, service_names


@subcommand("list")
@json_option
def list_types(*, as_json: bool) -> None:
    """List the service types that lcmtools knows.

    \b
    Examples:
      lcmtools srv list
      lcmtools srv list --json
    """
    show(service_names(), service_names(), as_json=as_json)


@subcommand("show")
@argument("type_", metavar="TYPE", completer="messages:service_types")
@option("-r", "--raw", is_flag=True, help="Show the .lcm files, with the comments.")
@json_option
def show_type(type_: str, *, raw: bool, as_json: bool) -> None:
    """Show the fields of a service type: request, a line of dashes, response.

    TYPE is std_srvs/Trigger, std_srvs/srv/Trigger, std_srvs.Trigger or Trigger.

    \b
    Examples:
      lcmtools srv show std_srvs/SetBool
      lcmtools srv show Trigger --json
    """
    from lcmtools.cli.msg.look import source_text  # list does without it
    from lcmtools.messages.definition import definition

    pair, name = service_class(type_), service_name(type_)
    text = source_text if raw else definition
    request, response = text(pair.Request), text(pair.Response)
    heading = [] if "/" in type_ or "." in type_ else [f"[{name}]:"]
    record = {"type": name, "request": request, "response": response}
    rows = [*heading, *request.splitlines(), "---", *response.splitlines()]
    show(record, rows, as_json=as_json)
