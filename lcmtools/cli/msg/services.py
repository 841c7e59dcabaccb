"""``lcmtools srv show``; ``msg show`` uses it for service types."""

import sys

from lcmtools.cli.declare import argument, examples, flag, subcommand
from lcmtools.cli.options import json_option
from lcmtools.cli.output import write_result
from lcmtools.errors import UsageError
from lcmtools.messages.registry import service_class, service_name


def piped_type(example: str) -> str:
    """Return the type on standard input. Raise UsageError unless there is exactly one."""
    example = f"for example lcmtools {example}"
    if sys.stdin is None or sys.stdin.isatty():
        raise UsageError("no type is given", example)
    words = sys.stdin.read().replace(",", " ").split()
    if len(words) != 1:
        raise UsageError(f"standard input has {'several types' if words else 'no type'}", example)
    return words[0]


@subcommand("show", json_option)
@examples(
    "srv show std_srvs/SetBool",
    "srv show Trigger --json",
    "service type /reset | lcmtools srv show",
)
@argument("type_", metavar="[TYPE]", default="-", completer="messages:service_types")
@flag("-r", "--raw", help="Show the .lcm or .srv files, with the comments.")
def show_service(type_: str, *, raw: bool, as_json: bool) -> None:
    """Show the fields of a service type: the request's, a line of dashes, the response's.

    TYPE is std_srvs/Trigger, std_srvs/srv/Trigger, std_srvs.Trigger or Trigger; "-" or none reads
    it from standard input.
    """
    type_ = piped_type("srv show std_srvs/SetBool") if type_ == "-" else type_
    print_service(type_, raw=raw, as_json=as_json)


def print_service(type_: str, *, raw: bool, as_json: bool) -> None:
    """Print the fields of a service type, or its files."""
    from lcmtools.messages.definition import definition
    from lcmtools.packages.user_types import source_file, source_text

    pair, name = service_class(type_), service_name(type_)
    text = source_text if raw else definition
    request, response = text(pair.Request), text(pair.Response)
    heading = [] if "/" in type_ or "." in type_ else [f"[{name}]:"]
    if raw and source_file(pair.Request).endswith(".srv"):  # which defines both
        request, response = (part.strip() for part in f"\n{request}\n".split("\n---", 1))
    record = {"type": name, "request": request, "response": response}
    rows = [*heading, *request.splitlines(), "---", *response.splitlines()]
    write_result(record, rows, as_json=as_json)
