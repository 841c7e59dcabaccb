"""``lcmtools type`` and ``find``."""

from lcmtools.cli.bus import look, looking_names
from lcmtools.cli.declare import argument, examples, flag, subcommand
from lcmtools.cli.options import all_option, json_option, looking_options
from lcmtools.cli.output import write_data, write_note, write_result
from lcmtools.errors import LcmtoolsError, ValueMismatch
from lcmtools.graph.model import Topic
from lcmtools.messages.path import Path, target
from lcmtools.messages.registry import message_class, type_name
from lcmtools.names import is_hidden
from lcmtools.observe.reading.find import find_topic_and_path, is_of_type
from lcmtools.observe.reports.describe import (
    NO_TYPE,
    UNKNOWN,
    fingerprint_rows,
    topic_kinds,
    types_record,
)


@subcommand("type", json_option, looking_options)
@examples(
    "type /husky0/odometry",
    "type /husky0/odometry/pose/covariance",
    "type /chatter | lcmtools msg show",
)
@argument("topic", completer="bus:topics")
def print_type(topic: str, *, as_json: bool) -> None:
    """Print the type of a topic, or of a field of its messages.

    For a field it prints the topic's type, the field and the field's type, as rostopic does.
    """
    names = looking_names()
    names.spellings(topic)  # refuses an empty name on any bus
    found, path = find_topic_and_path(look("type", foreign=True)[0], topic, names)
    kinds = topic_kinds(found)
    record = types_record(kinds, found.name)
    text = str(record["type"] or NO_TYPE)
    if path.steps:
        _show_field(found, text, path, as_json=as_json)
        return
    if text == UNKNOWN and not as_json:
        raise _unknown(found)
    for one in kinds:
        if len(one) > 1:
            write_note(f"{one[0]} is one of several types with the same fields: {', '.join(one)}")
    type_ = None if text == UNKNOWN else record["type"]
    write_result({"topic": found.name, **record, "type": type_}, [text], as_json=as_json)


def _show_field(topic: Topic, text: str, path: Path, *, as_json: bool) -> None:
    from lcmtools.messages.definition import array_type

    if text == UNKNOWN:
        raise _unknown(topic)
    try:
        found = target(message_class(text.partition(", ")[0]), path)
    except ValueMismatch as error:  # exit code 1, as for a missing topic
        raise LcmtoolsError(error.what, error.hint) from error
    field = str(path).replace(".", "/")
    kind = array_type(found.type, (*[""] * found.mapped, *found.dimensions))
    record = {"topic": topic.name, "type": text, "field": field, "field_type": kind}
    write_result(record, [f"{text} {field} {kind}"], as_json=as_json)


def _unknown(topic: Topic) -> LcmtoolsError:
    rows = "; ".join(fingerprint_rows(topic))
    return LcmtoolsError(f"the type of {topic.name} is not known", rows)


@subcommand("find", all_option, json_option, looking_options)
@examples("find geometry_msgs/Twist", "find std_msgs.String --json")
@argument("type_", metavar="TYPE", completer="messages:types")
@flag("-c", "--count-topics", help="Print only the number of topics.")
def find(type_: str, *, count_topics: bool, show_all: bool, as_json: bool) -> None:
    """List the topics of a type: announced by nodes, or by fingerprint for plain LCM programs.

    TYPE is geometry_msgs/Twist, geometry_msgs/msg/Twist, geometry_msgs.Twist or Twist.
    """
    name = type_name(message_class(type_, any_version=True))
    graph, url = look("find", foreign=True)
    topics = [topic for topic in graph.topic_names() if show_all or not is_hidden(topic)]
    found = [topic for topic in topics if is_of_type(graph.topic(topic), name)]
    if count_topics:
        write_data(str(len(found)))
        return
    write_result(found, found, as_json=as_json, none=f"no topics of type {name} on {url}")
