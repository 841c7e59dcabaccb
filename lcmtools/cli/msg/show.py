"""The commands of ``lcmtools msg`` that show a type."""

from lcmtools.cli.declare import argument, examples, flag, subcommand
from lcmtools.cli.msg.services import piped_type, print_service
from lcmtools.cli.options import json_option
from lcmtools.cli.output import write_data, write_document, write_lines, write_note, write_result
from lcmtools.messages.registry import fingerprint, message_class, type_name, type_names
from lcmtools.messages.type_source import shown


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
