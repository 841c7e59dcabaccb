"""The options of pub, and the lines that it tells the person."""

import click

from lcmtools.cli.declare import duration, flag, option, together, whole_number
from lcmtools.cli.options import rate_option, times_option
from lcmtools.cli.output import talk
from lcmtools.messages.plain import to_json
from lcmtools.messages.registry import Message

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
    flag("-s", "--substitute-keywords", help="Accepted as in rostopic; always on."),
    flag("--use-rostime", "--use-sim-time", "simulated", help="Take stamps from /clock."),
    flag("--literal", help="TOPIC is the exact LCM channel."),
    option(
        "-n",
        "--name",
        "--node-name",
        metavar="NAME",
        help="The name of this node; as __name:=NAME.",
    ),
)
"""The options of pub."""


def notify(text: str) -> None:
    """Tell the person something, also from threads that have no click context."""
    talk(f"lcmtools pub: {text}")


def tell_sent(count: int, message: Message, is_again: bool) -> None:  # noqa: FBT001 - OnSent's signature
    """Tell that a message was sent."""
    again = " again, to a new subscriber" if is_again else f": {to_json(message)}"
    talk(f"publishing #{count}{again}")
