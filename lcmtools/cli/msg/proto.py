"""``lcmtools msg proto``."""

from lcmtools.cli.declare import argument, subcommand
from lcmtools.cli.options import json_option
from lcmtools.cli.output import data
from lcmtools.messages.definition import prototype
from lcmtools.messages.plain import to_json
from lcmtools.messages.registry import message_class


@subcommand("proto")
@argument("type_", metavar="TYPE", completer="messages:types")
@json_option
def command(type_: str, *, as_json: bool) -> None:
    """Print a message of a type to fill in: YAML of all fields with their defaults, for pub.

    \b
    Examples:
      lcmtools msg proto geometry_msgs/Twist
      lcmtools msg proto sensor_msgs/Joy > joy.yaml
    """
    kind = message_class(type_)
    data(to_json(kind()) if as_json else prototype(kind))
