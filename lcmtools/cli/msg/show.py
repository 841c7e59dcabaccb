"""``lcmtools msg show``."""

import click

from lcmtools.cli.options import CONTEXT, json_option
from lcmtools.cli.output import data, document
from lcmtools.messages.definition import definition
from lcmtools.messages.registry import fingerprint, message_class, type_name


@click.command("show", context_settings=CONTEXT)
@click.argument("type_", metavar="TYPE")
@json_option
def command(type_: str, *, as_json: bool) -> None:
    """Show the fields of a message type, nested ones expanded.

    TYPE is geometry_msgs/Twist, geometry_msgs/msg/Twist, geometry_msgs.Twist or Twist.

    \b
    Examples:
      lcmtools msg show geometry_msgs/Twist
      lcmtools msg show $(lcmtools type /husky0/odometry)
    """  # noqa: D301 - \b is click's mark
    kind = message_class(type_)
    if as_json:
        document(
            {
                "type": type_name(kind),
                "fingerprint": f"{fingerprint(kind):#018x}",
                "definition": definition(kind),
            }
        )
        return
    if "/" not in type_ and "." not in type_:
        data(f"[{type_name(kind)}]:")
    data(definition(kind))
