"""``lcmtools pub``."""

from typing import Any

import click

from lcmtools.arguments import split_arguments
from lcmtools.cli.bus import chosen_url
from lcmtools.cli.declare import (
    accepted_for_ros,
    argument,
    duration,
    examples,
    flag,
    option,
    subcommand,
    together,
    whole_number,
)
from lcmtools.cli.negative_numbers import CommandWithWords, typed_words
from lcmtools.cli.options import bus_choice, bus_options, names_options, rate_option, times_option
from lcmtools.cli.output import write_note
from lcmtools.errors import UsageError, ValueMismatch
from lcmtools.messages.fields import visible_fields
from lcmtools.messages.plain import to_json
from lcmtools.messages.registry import Message, message_class
from lcmtools.publish.incoming import read_incoming
from lcmtools.publish.publication import check_topic, publish

publish_options = together(
    rate_option("Publish"),
    flag("-1", "--once", help="Publish one message and exit."),
    times_option("Publish"),
    flag("-l", "--latch", help="Keep running; latch the last message."),
    option("-f", "--file", type=click.Path(), help="Read a file ('-': standard input)."),
    option(
        "-w",
        "--wait-subscribers",
        "--wait-matching-subscriptions",
        "subscribers",
        metavar="N",
        type=whole_number(0),
        help="Wait for N subscribers before the first message.",
    ),
    option(
        "--timeout",
        "--max-wait",
        "--max-wait-time-secs",
        type=duration,
        help="Exit with code 4 if that takes longer.",
    ),
    option("--keep-alive", type=duration, help="Keep latching the last message for this long."),
    flag("-v", "--verbose", help="Print every message to standard error."),
    accepted_for_ros("-s", "--substitute-keywords"),  # stamps are always set on sending
    flag("--use-rostime", "--use-sim-time", "simulated", help="Take stamps from /clock."),
    flag("--literal", "--plain-channel", "plain_channel", help="TOPIC is the exact LCM channel."),
    option(
        "-n",
        "--name",
        "--node-name",
        metavar="NAME",
        help="The name of this node; as __name:=NAME.",
    ),
)
"""The options of pub."""


@subcommand("pub", names_options, bus_options, cls=CommandWithWords)
@examples(
    'pub /chatter std_msgs/String "data: hello"',
    'pub -r 10 cmd_vel geometry_msgs/Twist "{linear: [0.5, 0, 0], angular: [0, 0, 0.3]}"',
    'pub -1 /goal geometry_msgs/PoseStamped "{header: auto, pose: {position: {x: 1}}}"',
    "pub -1 -w 2 --timeout 10s /start std_msgs/Empty",
    "echo --json /odom | lcmtools pub /odom_copy nav_msgs/Odometry -",
)
@argument("topic", completer="bus:topics")
@argument("type_", metavar="TYPE", completer="messages:types")
@argument("values", nargs=-1, completer="messages:prototypes")
@publish_options
def command(
    topic: str,
    type_: str,
    values: tuple[str, ...],
    *,
    rate: float | None,
    once: bool,
    times: int | None,
    file: str | None,
    subscribers: int | None,
    timeout: float | None,
    keep_alive: float | None,
    verbose: bool,
    plain_channel: bool,
    name: str | None,
    **others: Any,  # noqa: ANN401 - of ``publish``
) -> None:
    """Publish messages on a topic; VALUES are YAML or JSON, as for rostopic.

    A dict sets fields by name; otherwise VALUES are the fields in order. A time, also a number like
    LCM's utime or timestamp, may be "now", a header "auto". Without -r, -1 or -t the message is
    sent once, and again to each new subscriber until Ctrl-C.

    The first message waits up to a second for a subscriber. "-" in place of VALUES is standard
    input; a file (-f) may contain several messages, separated by lines of ---.
    """
    check_topic(topic, plain_channel=plain_channel)
    flags = [*bus_choice().names.words(), *([f"--name={name}"] if name else [])]
    arguments, words = split_arguments([*flags, *values])
    kind = message_class(type_)
    if once and (rate is not None or times is not None):
        hint = "use one of them, or -- -1 for the value"
        raise UsageError(f"-{'r' if rate else 't'} and -1 exclude each other", hint)
    if timeout is not None and subscribers is None and (once or times):
        subscribers = 1  # as ros2
    elif timeout is not None and subscribers is None and not others["simulated"]:
        raise UsageError("--timeout is how long to wait for subscribers", "give the number by -w N")
    typed = typed_words()
    if once and typed[-1] == "-1" and not (words or file) and visible_fields(kind):
        raise UsageError("-1 may mean the option or the value", "write --once, or -- -1")
    try:
        incoming = read_incoming(kind, words, file, notify)
    except ValueMismatch as error:
        if "-1" not in typed[typed.index(type_) :]:
            raise
        raise ValueMismatch(error.what, "-1 is the option; -- -1 is the value") from error
    publish(
        topic,
        kind,
        incoming,
        rate=rate,
        count=1 if once else times,
        keep_alive=keep_alive or 0.0 if once else keep_alive,
        subscribers=subscribers,
        timeout=timeout,
        plain_channel=plain_channel,
        url=chosen_url(),
        arguments=arguments,
        notify=notify,
        on_start=lambda schedule: write_note(schedule.notice) if schedule.notice else None,
        on_sent=write_sent if verbose else lambda *_: None,
        **others,
    )


def notify(text: str) -> None:
    """Write a note, also from threads without a click context."""
    write_note(f"lcmtools pub: {text}")


def write_sent(count: int, message: Message, is_again: bool) -> None:  # noqa: FBT001 - OnSent's signature
    """Write a note that a message was sent."""
    again = " again, to a new subscriber" if is_again else f": {to_json(message)}"
    write_note(f"publishing #{count}{again}")
