"""``lcmtools msg find-field``."""

from lcmtools.cli.declare import argument, subcommand
from lcmtools.cli.options import json_option
from lcmtools.cli.output import show
from lcmtools.errors import LcmtoolsError
from lcmtools.messages.definition import declaration
from lcmtools.messages.fields import visible_fields
from lcmtools.messages.registry import message_class, type_names
from lcmtools.names import did_you_mean


@subcommand("find-field")
@argument("name")
@json_option
def command(name: str, *, as_json: bool) -> None:
    """Find the message types that have a field of this name themselves, not in a nested type.

    \b
    Examples:
      lcmtools msg find-field covariance
      lcmtools msg find-field header --json
    """
    known = [(t, field) for t in type_names() for field in visible_fields(message_class(t))]
    found = [(type_, declaration(field)) for type_, field in known if field.name == name]
    if not found:
        hint = did_you_mean(name, sorted({field.name for _, field in known}))
        raise LcmtoolsError(f"no message type has a field '{name}'", hint)
    record = [{"type": type_, "field": text} for type_, text in found]
    show(record, (f"{type_}: {text}" for type_, text in found), as_json=as_json)
