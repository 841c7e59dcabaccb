"""``lcmtools msg show``."""

import sys

import click

from lcmtools.cli.completion.completer import complete
from lcmtools.cli.msg.source import source_text
from lcmtools.cli.options import CONTEXT, json_option
from lcmtools.cli.output import data, document
from lcmtools.errors import UsageError
from lcmtools.messages.definition import definition
from lcmtools.messages.registry import fingerprint, message_class, type_name

_EXAMPLE = "for example lcmtools msg show geometry_msgs/Twist"


@click.command("show", context_settings=CONTEXT)
@click.argument("type_", metavar="[TYPE]", default="-", shell_complete=complete("messages:types"))
@click.option("-r", "--raw", is_flag=True, help="Show its .lcm file, with the comments.")
@json_option
def command(type_: str, *, raw: bool, as_json: bool) -> None:
    """Show the fields of a message type, nested ones expanded.

    TYPE is geometry_msgs/Twist, geometry_msgs/msg/Twist, geometry_msgs.Twist or Twist; "-" or none
    is the one that standard input says.

    \b
    Examples:
      lcmtools msg show geometry_msgs/Twist
      lcmtools msg show -r sensor_msgs/LaserScan
      lcmtools type /husky0/odometry | lcmtools msg show
    """  # noqa: D301 - \b is click's mark
    type_ = _piped() if type_ == "-" else type_
    kind = message_class(type_)
    show = source_text if raw else definition
    if as_json:
        document(
            {
                "type": type_name(kind),
                "fingerprint": f"{fingerprint(kind):#018x}",
                "definition": show(kind),
            }
        )
        return
    if "/" not in type_ and "." not in type_:
        data(f"[{type_name(kind)}]:")
    data(show(kind))


def _piped() -> str:
    """The type that standard input says.

    Raises:
        UsageError: It says none, or somebody would have to type it.
    """
    if sys.stdin is None or sys.stdin.isatty():
        raise UsageError("no type is given", _EXAMPLE)
    words = sys.stdin.read().replace(",", " ").split()
    if len(words) != 1:
        what = "several types" if words else "no type"
        raise UsageError(f"standard input has {what}", _EXAMPLE)
    return words[0]
