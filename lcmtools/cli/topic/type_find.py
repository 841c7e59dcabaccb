"""``lcmtools type`` and ``find``."""

from collections.abc import Mapping

from lcmtools.cli.bus import look, looking_names
from lcmtools.cli.declare import argument, examples, flag, subcommand
from lcmtools.cli.options import all_option, json_option, looking_options
from lcmtools.cli.output import write_data, write_result
from lcmtools.errors import LcmtoolsError, ValueMismatch
from lcmtools.graph.model import Topic
from lcmtools.messages.path import Path, target
from lcmtools.messages.registry import message_class, type_name
from lcmtools.names import has_wildcard, is_hidden
from lcmtools.observe.reading.find import is_of_type
from lcmtools.observe.reading.selection import selected_fields
from lcmtools.observe.reports.describe import UNKNOWN, fingerprint_rows, type_text

_KEYS = ("type", "field", "field_type")


@subcommand("type", json_option, looking_options)
@examples(
    "type /husky0/odometry",
    "type /husky0/odometry/pose/covariance",
    "type '/*/odometry'",
    "type /chatter | lcmtools msg show",
)
@argument("topic", completer="bus:topics")
def print_type(topic: str, *, as_json: bool) -> None:
    """Print the type of a topic, or of a field of its messages.

    For a field it prints the topic's type, the field and the field's type, as rostopic does. TOPIC
    may be a pattern: each topic that matches has its line.
    """
    names = looking_names()
    names.spellings(topic)  # refuses an empty name on any bus
    found = selected_fields(look("type", foreign=True)[0], topic, names)
    if has_wildcard(topic):
        records = [_record(*one) for one in found]
        write_result(records, map(_labelled, records), as_json=as_json)
        return
    ((one, path),) = found
    record = _record(one, path)
    if record["type"] is None and (path.steps or not as_json):
        rows = "; ".join(fingerprint_rows(one))
        raise LcmtoolsError(f"the type of {one.name} is not known", rows)
    write_result(record, [_text(record)], as_json=as_json)


def _record(topic: Topic, path: Path) -> dict[str, str | None]:
    """Return a topic's type for JSON, None if it is not known, and that of a field."""
    from lcmtools.messages.definition import array_type

    text = type_text(topic)
    record = {"topic": topic.name, "type": None if text == UNKNOWN else text}
    if not path.steps or text == UNKNOWN:
        return record
    try:
        found = target(message_class(text.partition(", ")[0]), path)
    except ValueMismatch as error:  # exit code 1, as for a missing topic
        raise LcmtoolsError(error.what, error.hint) from error
    kind = array_type(found.type, (*[""] * found.mapped, *found.dimensions))
    return record | {"field": str(path).replace(".", "/"), "field_type": kind}


def _text(record: Mapping[str, str | None]) -> str:
    return " ".join(str(record[key] or UNKNOWN) for key in _KEYS if key in record)


def _labelled(record: Mapping[str, str | None]) -> str:
    return f"{record['topic']}: {_text(record)}"


@subcommand("find", all_option, json_option, looking_options)
@examples("find geometry_msgs/Twist", "find std_msgs.String --json")
@argument("type_", metavar="TYPE", completer="messages:types")
@flag("-c", "--count-topics", help="Print only the number of topics.")
def find(type_: str, *, count_topics: bool, show_all: bool, as_json: bool) -> None:
    """List the topics of a type: announced by nodes, or by fingerprint for plain LCM programs.

    TYPE is geometry_msgs/Twist, geometry_msgs/msg/Twist, geometry_msgs.Twist or Twist.
    """
    name = type_name(message_class(type_))
    graph, url = look("find", foreign=True)
    topics = [topic for topic in graph.topic_names() if show_all or not is_hidden(topic)]
    found = [topic for topic in topics if is_of_type(graph.topic(topic), name)]
    if count_topics:
        write_data(str(len(found)))
        return
    write_result(found, found, as_json=as_json, none=f"no topics of type {name} on {url}")
