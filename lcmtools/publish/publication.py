"""Publishing messages on a topic, as ``lcmtools pub`` does."""

import os
from collections.abc import Callable, Iterator
from shlex import quote
from typing import TypeAlias

from lcmtools.arguments import NodeArguments
from lcmtools.bus.url import BusUrl, choose_url
from lcmtools.errors import UsageError
from lcmtools.messages.fill import Value
from lcmtools.messages.message_template import MessageTemplate, draft, draft_from_values
from lcmtools.messages.registry import Message, message_class, type_name
from lcmtools.messages.supply import has_supply
from lcmtools.node.node import Node
from lcmtools.observe.actuators import is_command_topic
from lcmtools.packages import provide_user_types
from lcmtools.publish.incoming import Incoming, Notify, Template
from lcmtools.publish.schedule import OnSent, Schedule, ScheduledPublisher, schedule_for
from lcmtools.publish.standing_command import obeying, standing_command
from lcmtools.publish.subscriber_wait import SubscriberWait
from lcmtools.publish.temporary_node import temporary_node
from lcmtools.settings import read_user_file

One: TypeAlias = "Message | Value"
"""A message, or its fields: as YAML, a dict, or a list of all of them in order."""
Values: TypeAlias = "One | Iterator[One] | Incoming"
"""One message, or several that are sent as they come."""


def publish(  # noqa: PLR0913 - one parameter an option of pub
    topic: str,
    message_type: str | type[Message],
    values: Values = None,
    *,
    rate: float | None = None,
    count: int | None = None,
    latch: bool = False,
    keep_alive: float | None = None,
    subscribers: int | None = None,
    timeout: float | None = None,
    simulated: bool = False,
    plain_channel: bool = False,
    url: str | BusUrl | None = None,
    arguments: NodeArguments | None = None,
    notify: Notify = lambda _: None,
    on_start: Callable[[Schedule], None] = lambda _: None,
    on_sent: OnSent = lambda *_: None,
) -> int:
    """Publish messages on a topic with a temporary node; return the number of sent messages.

    With none of ``rate``, ``count`` and ``keep_alive`` a single message is latched, as with
    ``pub``: it is sent to each new subscriber until the program is interrupted.

        publish("/chatter", "std_msgs/String", "data: hello", count=1)
        publish("/cmd_vel", Twist, {"linear": [0.5, 0, 0]}, rate=10, count=50)

    Args:
        topic: Its name, resolved by the ROS rules.
        message_type: The messages' class, or its name ("geometry_msgs/Twist").
        values: One message, or an iterator of messages that are sent as they come. None for the
            type's default message. Times may be "now" and headers "auto": they are set on sending.
        rate: Messages per second [Hz]; without ``count``, a single message is repeated without end.
        count: The number of messages to send, at ``rate`` or 1 Hz; fewer messages are repeated.
        latch: Keep running, and send the last message to each new subscriber.
        keep_alive: Time to keep running after the last message, and to latch it [s].
        subscribers: The number of nodes that must subscribe before the first message; None: wait up
            to a second for one.
        timeout: Longest wait for these nodes and for /clock [s]; None for no limit.
        simulated: Take time stamps from /clock.
        plain_channel: The topic is the exact LCM channel.
        url: The bus; None for the one that the environment and the settings file select.
        arguments: The node's name, namespace and remaps.
        notify: Called with sentences for the user, for example while it waits for subscribers.
        on_start: Called with the schedule before the first message.
        on_sent: Called with each message that was sent; see ``OnSent``.

    Raises:
        UnknownType: There is no such type.
        ValueMismatch: A value does not fit its field.
        UsageError: The rate or the count is not positive.
        InvalidName: The topic's name breaks the naming rules.
        NothingReceived: Too few nodes subscribe, or /clock is silent, until ``timeout``.
        BusError: The bus cannot be reached, or does not accept a message.
    """
    if not has_supply():
        provide_user_types()
    kind = message_class(message_type) if isinstance(message_type, str) else message_type
    incoming = values if isinstance(values, Incoming) else _incoming(kind, values)
    schedule = schedule_for(incoming, rate=rate, count=count, latch=latch, keep_alive=keep_alive)
    bus = _bus_url(url)
    with temporary_node("pub", bus, arguments or NodeArguments(), simulated=simulated) as node:
        publisher = node.create_publisher(kind, topic, plain_channel=plain_channel)
        publisher.is_latched = latch or schedule.stay > 0
        literal = "" if plain_channel or topic.startswith(("/", "~")) else topic
        wait = SubscriberWait(node, publisher, bus, notify, literal)
        if simulated:
            wait.wait_for_clock(timeout)
        wait.wait(subscribers, timeout)
        endures = schedule.is_endless or incoming.is_stream or schedule.stay > 0
        scheduled = ScheduledPublisher(
            node, publisher, publisher.is_latched, endures, notify=notify, on_sent=on_sent
        )
        on_start(schedule)
        try:
            scheduled.send_all(incoming, schedule)
        finally:
            if scheduled.last is not None:
                _tell_standing(node, publisher.topic, scheduled.last.message, bus, notify)
        return scheduled.count


def check_topic(topic: str, *, plain_channel: bool) -> None:
    """Refuse a topic that no node could announce; the node checks the naming rules.

    Raises:
        UsageError: The topic is refused; the error has the reason.
    """
    if not (topic if plain_channel else topic.strip("/ ")):
        raise UsageError("the topic's name is empty", "give one, for example /chatter")
    if any("\ud800" <= character <= "\udfff" for character in topic):
        raise UsageError(f"{topic!a} is not UTF-8", "nodes cannot use other channels")


def _tell_standing(node: Node, topic: str, message: Message, bus: BusUrl, notify: Notify) -> None:
    """Tell of a command that an actuator goes on to obey, with the line that stops it."""
    kind = type_name(message)
    is_heard = is_command_topic(topic, kind) and node.has_plain_listeners(at_once=True)
    standing = standing_command(topic, kind, message)
    if standing.values and (is_heard or obeying(node.graph(), topic, kind)):
        where = f" --lcm-url {quote(str(bus))}" if standing.typed and bus != _bus_url(None) else ""
        notify(f"{standing.lasting}{where}")


def _incoming(kind: type[Message], values: "One | Iterator[One]") -> Incoming:
    if isinstance(values, Iterator):
        return Incoming(_template(kind, value) for value in values)
    return Incoming(iter([_template(kind, values)]), is_one=True)


def _template(kind: type[Message], value: One) -> Template:
    if isinstance(value, kind):
        return MessageTemplate(value)
    if isinstance(value, str):
        return draft_from_values(kind, [value])
    return draft(kind, value)  # type: ignore[arg-type] # draft refuses a message of another type


def _bus_url(url: str | BusUrl | None) -> BusUrl:
    if isinstance(url, BusUrl):
        return url
    return choose_url(url or None, None, os.environ, read_user_file(os.environ))[0]
