"""``lcmtools msg fingerprint``."""

from lcmtools.cli.declare import argument, subcommand
from lcmtools.cli.options import json_option
from lcmtools.cli.output import show
from lcmtools.messages.registry import fingerprint, message_class, type_name, type_names


@subcommand("fingerprint")
@argument("type_", metavar="TYPE", completer="messages:types")
@json_option
def command(type_: str, *, as_json: bool) -> None:
    """Print a type's fingerprint: the first 8 bytes of its messages, in hexadecimal.

    Types with the same fields have the same fingerprint. TYPE without its package stands for each
    type of that name.

    \b
    Examples:
      lcmtools msg fingerprint geometry_msgs/Twist
      lcmtools msg md5 Twist
    """
    named = [name for name in type_names() if name.rpartition("/")[2] == type_]
    kinds = map(message_class, named or [type_])
    found = {type_name(kind): f"{fingerprint(kind):016x}" for kind in kinds}
    record = [{"type": name, "fingerprint": digits} for name, digits in found.items()]
    rows = (f"[{name}]: {digits}" if named else digits for name, digits in found.items())
    show(record, rows, as_json=as_json)
