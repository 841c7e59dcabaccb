"""The commands of ``lcmtools msg`` and ``srv`` that list types."""

from lcmtools.cli.declare import argument, examples, flag, subcommand
from lcmtools.cli.options import json_option
from lcmtools.cli.output import write_note, write_result
from lcmtools.errors import LcmtoolsError, UnknownType
from lcmtools.messages.registry import message_class, packages, problems, service_names, type_names
from lcmtools.names import did_you_mean

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
