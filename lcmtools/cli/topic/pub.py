"""``lcmtools pub``."""

import contextlib
import os
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import click

import lcmtools
from lcmtools.arguments import NodeArguments, split_arguments
from lcmtools.cli.options import CONTEXT, bus_options, chosen_url
from lcmtools.cli.options import rate as rate_option
from lcmtools.cli.output import talk
from lcmtools.cli.topic.negative import CommandWithValues, ends_in_one
from lcmtools.errors import InvalidFile, UsageError, ValueMismatch
from lcmtools.messages.fields import fields
from lcmtools.messages.registry import Message, message_class
from lcmtools.messages.yaml_input import message_from_values, messages_from_document
from lcmtools.node.publisher import Publisher

_WAIT_FOR_SUBSCRIBER = 1.0  # [s]
_POLL = 0.02  # [s]
_FILE_RATE = 10.0  # [Hz] for a file of several messages, as rostopic


@dataclass(frozen=True, slots=True)
class _Plan:
    """What to send and when.

    Attributes:
        messages: In order; at least one.
        rate: Messages a second; None for as the messages' number has it.
        once: Send the first and end.
    """

    messages: Sequence[Message]
    rate: float | None
    once: bool


@click.command("pub", cls=CommandWithValues, context_settings=CONTEXT)
@click.argument("topic")
@click.argument("type_", metavar="TYPE")
@click.argument("values", nargs=-1)
@click.option("-r", "--rate", type=rate_option, help="Publish so many times a second until Ctrl-C.")
@click.option("-1", "--once", is_flag=True, help="Publish once and end.")
@click.option(
    "-f", "--file", type=click.Path(), help="Read messages from a YAML file ('-': standard input)."
)
@click.option("--literal", is_flag=True, help="TOPIC is the LCM channel, to the letter.")
@click.option("--ns", metavar="NAME", help="The namespace that TOPIC stands in; as __ns:=NAME.")
@click.option("--name", metavar="NAME", help="The name of this node; as __name:=NAME.")
@click.option("--remap", metavar="FROM:=TO", multiple=True, help="Another topic in place of FROM.")
@bus_options
def command(  # noqa: PLR0913 - one parameter an option
    topic: str,
    type_: str,
    values: tuple[str, ...],
    *,
    rate: float | None,
    once: bool,
    file: str | None,
    literal: bool,
    ns: str | None,
    name: str | None,
    remap: tuple[str, ...],
) -> None:
    """Publish messages on a topic; VALUES are YAML, as rostopic takes them.

    One value that is a dict names fields; otherwise values are the fields in order. Fields that
    are left out keep their defaults. Without -r and -1 the message is sent once and again to each
    subscriber that appears, until Ctrl-C.

    \b
    Examples:
      lcmtools pub /chatter std_msgs/String "data: hello"
      lcmtools pub -r 10 cmd_vel geometry_msgs/Twist "{linear: [0.5, 0, 0], angular: [0, 0, 0.3]}"
    """  # noqa: D301 - \b is click's mark
    if rate is not None and once:
        raise UsageError("-r and -1 exclude each other", "use one of them")
    _check(topic, literal=literal)
    flags = {"--ns": [ns], "--name": [name], "--remap": remap}
    said = [f"{flag}={value}" for flag, given in flags.items() for value in given if value]
    names, words = split_arguments([*said, *values])
    kind = message_class(type_)
    if ends_in_one() and not (words or file) and fields(kind):
        raise UsageError("-1 may mean the option or the value", "write --once, or -- -1")
    plan = _Plan(_read(kind, words, file), rate, once)
    with _publisher(kind, topic, names, literal=literal) as publisher:
        _wait_for_subscriber(publisher)
        _follow(plan, publisher)


def _check(topic: str, *, literal: bool) -> None:
    """Refuse what no node could announce; the rest is the naming rules' business."""
    if not literal and not topic.strip("/ "):
        raise UsageError("the topic's name is empty", "give one, for example /chatter")
    if any("\ud800" <= character <= "\udfff" for character in topic):
        raise UsageError(f"{topic!a} is not UTF-8", "nodes can name no other channel")


def _read(kind: type[Message], values: Sequence[str], file: str | None) -> list[Message]:
    """The messages to send; everything is read and checked before anything is sent.

    Raises:
        UsageError: Values and a file are both given, or the file has no message.
        InvalidFile: The file cannot be read.
        ValueMismatch: A value does not fit its field.
    """
    if file is None:
        return [message_from_values(kind, values)]
    if values:
        raise UsageError("values and -f exclude each other", "use one of them")
    source = "standard input" if file == "-" else file
    try:
        text = (sys.stdin.buffer.read() if file == "-" else Path(file).read_bytes()).decode()
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not UTF-8 text"
        raise InvalidFile(f"cannot read {source}: {reason}") from error
    try:
        messages = list(messages_from_document(kind, text))
    except ValueMismatch as mismatch:
        raise ValueMismatch(f"{source}: {mismatch.what}", mismatch.hint) from None
    if not messages:
        raise UsageError(f"{source} has no message in it", "write YAML documents, separated by ---")
    return messages


@contextlib.contextmanager
def _publisher(
    kind: type[Message], topic: str, names: NodeArguments, *, literal: bool
) -> Iterator[Publisher[Message]]:
    """A publisher of a node of this command's own.

    Raises:
        InvalidName: The topic's name breaks the naming rules.
        BusError: The bus cannot be reached.
    """
    lcmtools.init(_as_arguments(names), url=str(chosen_url()), handle_signals=False)
    try:
        with lcmtools.Node(f"_lcmtools_pub_{os.getpid()}", tool=True) as node:
            yield node.create_publisher(kind, topic, literal=literal)
    finally:
        lcmtools.shutdown()


def _as_arguments(names: NodeArguments) -> list[str]:
    """The naming arguments among the values, for the node."""
    return [
        *([f"__ns:={names.namespace}"] if names.namespace else []),
        *([f"__name:={names.name}"] if names.name else []),
        *(f"{source}:={target}" for source, target in names.remaps),
        *(["--lcm-url", names.lcm_url] if names.lcm_url else []),
        *(["--domain", names.domain] if names.domain else []),
    ]


def _wait_for_subscriber(publisher: Publisher[Message]) -> None:
    """Wait up to a second for somebody who can hear. Plain LCM programs never announce."""
    deadline = time.monotonic() + _WAIT_FOR_SUBSCRIBER
    while time.monotonic() < deadline:
        if publisher.subscriber_count():
            return
        time.sleep(_POLL)
    talk(f"lcmtools pub: no node subscribes to {publisher.topic} yet; publishing all the same")


def _follow(plan: _Plan, publisher: Publisher[Message]) -> None:
    if plan.once:
        publisher.publish(plan.messages[0])
    elif plan.rate is not None and len(plan.messages) == 1:
        _publish_at(plan.rate, publisher, plan.messages[0])
    elif len(plan.messages) > 1:
        for message in plan.messages:
            publisher.publish(message)
            time.sleep(1 / (plan.rate or _FILE_RATE))
    else:
        _latch(publisher, plan.messages[0])


def _publish_at(rate: float, publisher: Publisher[Message], message: Message) -> None:
    """Publish at a fixed rate, without drift, until interrupted."""
    start = time.monotonic()
    count = 0
    while True:
        publisher.publish(message)
        count += 1
        time.sleep(max(0.0, start + count / rate - time.monotonic()))


def _latch(publisher: Publisher[Message], message: Message) -> None:
    """Publish, and again for each subscriber that appears, until interrupted."""
    talk("publishing and latching message. Press ctrl-C to terminate")
    served = publisher.subscriber_ids()
    publisher.publish(message)
    while True:
        time.sleep(_POLL)
        present = publisher.subscriber_ids()
        if present - served:
            publisher.publish(message)
        served = present
