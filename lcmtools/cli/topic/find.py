"""``lcmtools find``."""

from lcmtools.cli.declare import argument, option, subcommand
from lcmtools.cli.options import all_option, json_option, looking_options, open_monitor
from lcmtools.cli.output import data, show, talk
from lcmtools.graph.model import Topic
from lcmtools.messages.registry import candidates, message_class, type_name
from lcmtools.names import is_hidden


@subcommand("find")
@argument("type_", metavar="TYPE", completer="messages:types")
@option("-c", "--count-topics", is_flag=True, help="Print only the number of topics.")
@all_option
@json_option
@looking_options
def command(type_: str, *, count_topics: bool, show_all: bool, as_json: bool) -> None:
    """List the topics of a type: announced by nodes, or by fingerprint for plain LCM programs.

    TYPE is geometry_msgs/Twist, geometry_msgs/msg/Twist, geometry_msgs.Twist or Twist.

    \b
    Examples:
      lcmtools find geometry_msgs/Twist
      lcmtools find std_msgs.String --json
    """
    name = type_name(message_class(type_))
    with open_monitor("find") as monitor:
        graph, url = monitor.settle(), monitor.url
    topics = [topic for topic in graph.topic_names() if show_all or not is_hidden(topic)]
    found = [topic for topic in topics if is_of_type(graph.topic(topic), name)]
    if count_topics:
        data(str(len(found)))
        return
    show(found, found, as_json=as_json)
    if not found:
        talk(f"no topics of type {name} on {url}")


def is_of_type(topic: Topic, name: str) -> bool:
    """Return whether a type is announced, or may be what a program that announces nothing sends.

    A fingerprint that an announced type has too is taken for that type's.
    """
    seen = map(candidates, topic.fingerprints)
    return name in topic.types or any(
        name in names and not set(names) & set(topic.types) for names in seen
    )
