"""``lcmtools service type`` and ``args``."""

from lcmtools.cli.declare import argument, subcommand
from lcmtools.cli.options import in_names, json_option, looking_names, looking_options, open_monitor
from lcmtools.cli.output import data, document, lines
from lcmtools.errors import LcmtoolsError
from lcmtools.messages.fields import visible_fields
from lcmtools.observe.find import find_service


@subcommand("type")
@argument("service", completer="bus:services")
@json_option
@looking_options
def type_(service: str, *, as_json: bool) -> None:
    """Print a service's type.

    \b
    Examples:
      lcmtools service type /reset
      lcmtools srv show $(lcmtools service type /reset)
    """
    with open_monitor("service_type") as monitor:
        found = find_service(
            monitor.settle(foreign=False), in_names(service), looking_names().namespace
        )
    if as_json:
        document({"service": found.name, "type": found.type_text if found.types else None})
    elif not found.types:
        raise LcmtoolsError(f"the type of {found.name} is not known")
    else:
        lines([found.type_text])


@subcommand("args")
@argument("service", completer="bus:services")
@json_option
@looking_options
def args(service: str, *, as_json: bool) -> None:
    """Print the names of a service's arguments: the fields of its request.

    \b
    Examples:
      lcmtools service args /switch
      lcmtools service args /switch --json
    """
    with open_monitor("service_args") as monitor:
        found = find_service(
            monitor.settle(foreign=False), in_names(service), looking_names().namespace
        )
    names = [field.name for field in visible_fields(found.type_class().Request)]
    document(names) if as_json else data(" ".join(names))
