"""``lcmtools msg show``."""

import sys
from pathlib import Path

from lcmtools.cli.declare import argument, option, subcommand
from lcmtools.cli.options import json_option
from lcmtools.cli.output import data, document
from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.messages.definition import definition
from lcmtools.messages.registry import (
    Message,
    default_registry,
    fingerprint,
    message_class,
    type_name,
)
from lcmtools.packages.type_files import shipped_folder

_EXAMPLE = "for example lcmtools msg show geometry_msgs/Twist"


@subcommand("show")
@argument("type_", metavar="[TYPE]", default="-", completer="messages:types")
@option("-r", "--raw", is_flag=True, help="Show its .lcm file, with the comments.")
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
    """
    type_ = _piped() if type_ == "-" else type_
    kind = message_class(type_)
    name, text = type_name(kind), (source_text if raw else definition)(kind)
    if as_json:
        number = f"{fingerprint(kind):#018x}"
        document({"type": name, "fingerprint": number, "definition": text})
    else:
        data(text if "/" in type_ or "." in type_ else f"[{name}]:\n{text}")


def source_text(kind: type[Message]) -> str:
    """Return the .lcm file of a message type, as its author wrote it.

    Raises:
        LcmtoolsError: The file cannot be read.
    """
    name = type_name(kind)
    file = default_registry().files().get(name) or f"{shipped_folder() / name}.lcm"
    try:
        return Path(file).read_text("utf-8").strip()
    except (OSError, UnicodeDecodeError) as error:
        raise LcmtoolsError(f"cannot read {file}, where {name} is from: {error}") from error


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
