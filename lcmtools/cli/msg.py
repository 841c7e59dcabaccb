"""``lcmtools msg`` and ``srv``."""

import sys

from lcmtools.cli.declare import argument, examples, flag, subcommand
from lcmtools.cli.options import json_option
from lcmtools.cli.output import (
    write_data,
    write_document,
    write_lines,
    write_note,
    write_result,
)
from lcmtools.errors import LcmtoolsError, UnknownType, UsageError
from lcmtools.messages.registry import (
    fingerprint,
    message_class,
    packages,
    problems,
    service_class,
    service_name,
    service_names,
    type_name,
    type_names,
)
from lcmtools.messages.type_source import shown
from lcmtools.names import did_you_mean


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


_single_line_option = flag("-s", "--single-line", help="All on one line, separated by spaces.")


@subcommand("list", json_option)
@examples("msg list", "msg list --json")
def list_types(*, as_json: bool) -> None:
    """List the message types that lcmtools knows."""
    for problem in problems():
        write_note(str(problem.error()), "lcmtools msg list")
    write_result(type_names(), type_names(), as_json=as_json)


@subcommand("package", json_option)
@examples("msg package geometry_msgs", "msg package std_msgs --json")
@argument("package", completer="messages:packages")
@_single_line_option
def package_command(package: str, *, single_line: bool, as_json: bool) -> None:
    """List the message types of a package."""
    found = [name for name in type_names() if name.startswith(f"{package}/")]
    if not found:
        hint = did_you_mean(package, packages()) or "see: lcmtools msg packages"
        raise UnknownType(f"unknown package '{package}'", hint)
    write_result(found, [" ".join(found)] if single_line else found, as_json=as_json)


@subcommand("packages", json_option)
@examples("msg packages", "msg packages --json")
@_single_line_option
def packages_command(*, single_line: bool, as_json: bool) -> None:
    """List the packages that have message types."""
    found = packages()
    write_result(found, [" ".join(found)] if single_line else found, as_json=as_json)


@subcommand("find-field", json_option)
@examples("msg find-field covariance", "msg find-field header --json")
@argument("name")
def find_field(name: str, *, as_json: bool) -> None:
    """Find the message types with a field of this name, nested types not included."""
    from lcmtools.messages.definition import declaration  # not needed otherwise
    from lcmtools.messages.fields import fields

    known = [(t, field) for t in type_names() for field in fields(message_class(t))]
    found = [(type_, declaration(field)) for type_, field in known if field.name == name]
    if not found:
        hint = did_you_mean(name, sorted({field.name for _, field in known}))
        raise LcmtoolsError(f"no message type has a field '{name}'", hint)
    record = [{"type": type_, "field": text} for type_, text in found]
    write_result(record, (f"{type_}: {text}" for type_, text in found), as_json=as_json)


@subcommand("list", json_option)
@examples("srv list", "srv list --json")
def list_services(*, as_json: bool) -> None:
    """List the service types that lcmtools knows."""
    write_result(service_names(), service_names(), as_json=as_json)


@subcommand("fingerprint", json_option)
@examples("msg fingerprint geometry_msgs/Twist", "msg md5 Twist")
@argument("type_", metavar="TYPE", completer="messages:types")
def print_fingerprint(type_: str, *, as_json: bool) -> None:
    """Print a type's fingerprint: the first 8 bytes of its messages, in hexadecimal.

    Types with the same fields have the same fingerprint. TYPE without a package means all types of
    that name.
    """
    named = [name for name in type_names() if name.rpartition("/")[2] == type_]
    kinds = map(message_class, named or [type_])
    found = {type_name(kind): f"{fingerprint(kind):016x}" for kind in kinds}
    record = [{"type": name, "fingerprint": digits} for name, digits in found.items()]
    rows = (f"[{name}]: {digits}" if named else digits for name, digits in found.items())
    write_result(record, rows, as_json=as_json)


@subcommand("proto", json_option)
@examples("msg proto geometry_msgs/Twist", "msg proto sensor_msgs/Joy > joy.yaml")
@argument("type_", metavar="TYPE", completer="messages:types")
def proto(type_: str, *, as_json: bool) -> None:
    """Print a type's fields with their defaults as YAML, to fill in for pub."""
    from lcmtools.messages.definition import prototype
    from lcmtools.messages.plain import to_json

    kind = message_class(type_)
    write_data(to_json(kind()) if as_json else prototype(kind))


@subcommand("show", json_option)
@examples(
    "msg show geometry_msgs/Twist",
    "msg show -r sensor_msgs/LaserScan",
    "type /husky0/odometry | lcmtools msg show",
)
@argument("type_", metavar="[TYPE]", default="-", completer="messages:types")
@flag("-r", "--raw", help="Show its .lcm or .msg file, with the comments.")
def show_type(type_: str, *, raw: bool, as_json: bool) -> None:
    """Show the fields of a message type, nested ones expanded, with ROS's names of types.

    TYPE is geometry_msgs/Twist, geometry_msgs/msg/Twist, geometry_msgs.Twist or Twist; "-" or none
    reads it from standard input. std_srvs/srv/Trigger is a service, shown as srv show does.
    """
    from lcmtools.messages.definition import definition
    from lcmtools.packages.user_types import source_file, source_text

    type_ = piped_type("msg show geometry_msgs/Twist") if type_ == "-" else type_
    if "/srv/" in type_:  # as in ros2 interface show
        print_service(type_, raw=raw, as_json=as_json)
        return
    kind = message_class(type_)
    name, text = type_name(kind), (source_text if raw else definition)(kind)
    file = source_file(kind)
    spelling = "LCM" if raw and file.endswith(".lcm") else "ROS"
    if as_json:
        number = f"{fingerprint(kind):#018x}"
        write_document(
            {"type": name, "fingerprint": number, "spelling": spelling, "definition": text}
        )
    else:
        heading = [] if "/" in type_ or "." in type_ else [f"[{name}]:"]
        write_lines([*heading, *text.replace("\r\n", "\n").split("\n")])
        write_note(
            f"types are spelt as in {spelling}; {'this is' if raw else '-r shows'} {shown(file)}"
        )
