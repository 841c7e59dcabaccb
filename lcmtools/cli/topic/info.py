"""``lcmtools info``, ``type`` and ``find``."""

from lcmtools.cli.bus import look, looking_names, open_monitor
from lcmtools.cli.declare import argument, duration, examples, flag, option, subcommand
from lcmtools.cli.options import all_option, json_option, looking_options
from lcmtools.cli.output import write_data, write_document, write_lines, write_note, write_result
from lcmtools.errors import LcmtoolsError, UsageError, ValueMismatch
from lcmtools.graph.model import Topic
from lcmtools.messages.path import Path, target
from lcmtools.messages.registry import message_class, type_name
from lcmtools.names import has_wildcard, is_hidden
from lcmtools.observe.measuring.measure import watch_counters
from lcmtools.observe.reading.find import is_of_type
from lcmtools.observe.reading.selection import selected_fields, selected_topics
from lcmtools.observe.reports import topic_report
from lcmtools.observe.reports.describe import (
    NO_TYPE,
    UNKNOWN,
    fingerprint_rows,
    topic_kinds,
    types_json,
)
from lcmtools.observe.reports.program_report import listeners_text


@subcommand("info", json_option, looking_options)
@examples("info /husky0/odometry", "info EXAMPLE /chatter --json", "info '/*/odometry'")
@argument("topics", nargs=-1, required=True, completer="bus:topics")
@option("--wait", type=duration, help="Measure rates for this long (else as nodes announce them).")
@flag("-v", "--verbose", help="Show fingerprints and command lines too.")
def command(topics: tuple[str, ...], *, wait: float | None, verbose: bool, as_json: bool) -> None:
    """Show a topic's type, publishers and subscribers: node, host and process.

    Counters for each: messages, bytes, messages dropped from a full queue, queue depth, rate, and
    time of the last message. For plain LCM programs these are observed values; those that listen
    are named, for their channels are not seen. For publishers also the number of messages lost on
    the way here, by sequence numbers. TOPIC may be a pattern.
    """
    names = looking_names()
    with open_monitor("info") as monitor:
        from lcmtools.observe.reading.senders import listening_programs

        try:
            graph, counters = watch_counters(monitor, topics, wait, names, with_messages=verbose)
        except UsageError:
            raise
        except LcmtoolsError as error:
            listeners = listening_programs(monitor.graph(), monitor.url)
            raise _perhaps_received(error, listeners_text(listeners)) from None
        listeners = listening_programs(graph, monitor.url)
    found = selected_topics(graph, topics, names)
    if as_json:
        write_document([topic_report.to_json(topic, counters, listeners) for topic in found])
        return
    for topic in found:
        write_lines([f"Topic: {topic.name}"] if len(found) > 1 else [])
        write_lines(topic_report.to_lines(topic, counters, listeners, verbose=verbose))


def _perhaps_received(error: LcmtoolsError, listeners: str) -> LcmtoolsError:
    """Return the error for a topic that nobody publishes, with the programs that may receive it."""
    more = f"on which channels these listen is not seen: {listeners}" if listeners else ""
    return LcmtoolsError(error.what, "; ".join(filter(None, (error.hint, more))))


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
    shown = [_record_and_text(*one) for one in found]
    if has_wildcard(topic):
        rows = (f"{record['topic']}: {text}" for record, text in shown)
        write_result([record for record, _ in shown], rows, as_json=as_json)
        return
    ((one, path),), ((record, text),) = found, shown
    if text == UNKNOWN and (path.steps or not as_json):
        hint = "; ".join(fingerprint_rows(one))
        raise LcmtoolsError(f"the type of {one.name} is not known", hint)
    for kind in topic_kinds(one):
        if len(kind) > 1 and not path.steps:
            write_note(f"{kind[0]} is one of several types with the same fields: {', '.join(kind)}")
    write_result(record, [text], as_json=as_json)


def _record_and_text(topic: Topic, path: Path) -> tuple[dict[str, object], str]:
    """Return a topic's type, or that of a field, for JSON and as a line."""
    from lcmtools.messages.definition import array_type

    record = types_json(topic_kinds(topic), topic.name)
    text = str(record["type"] or NO_TYPE)
    if not path.steps or text == UNKNOWN:
        type_ = None if text == UNKNOWN else record["type"]
        return {"topic": topic.name, **record, "type": type_}, text
    try:
        found = target(message_class(text.partition(", ")[0]), path)
    except ValueMismatch as error:  # exit code 1, as for a missing topic
        raise LcmtoolsError(error.what, error.hint) from error
    field = str(path).replace(".", "/")
    kind = array_type(found.type, (*[""] * found.mapped, *found.dimensions))
    field_record: dict[str, object] = {
        "topic": topic.name,
        "type": text,
        "field": field,
        "field_type": kind,
    }
    return field_record, f"{text} {field} {kind}"


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
