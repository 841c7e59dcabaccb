"""``lcmtools pub``."""

import math

import click

from lcmtools.arguments import split_arguments
from lcmtools.cli.completion.completer import complete
from lcmtools.cli.options import CONTEXT, bus_options, chosen_url, duration, whole_number
from lcmtools.cli.options import rate as rate_option
from lcmtools.cli.output import talk
from lcmtools.cli.topic.negative import CommandWithValues, ends_in_one
from lcmtools.errors import UsageError
from lcmtools.messages.fields import fields
from lcmtools.messages.registry import message_class
from lcmtools.publish.incoming import read_incoming
from lcmtools.publish.own_node import own_node, wait_for_clock
from lcmtools.publish.pace import PublishOptions
from lcmtools.publish.sender import Sender, send_all
from lcmtools.publish.subscriber_wait import SubscriberWait, Wanted


@click.command("pub", cls=CommandWithValues, context_settings=CONTEXT)
@click.argument("topic", shell_complete=complete("bus:topics"))
@click.argument("type_", metavar="TYPE", shell_complete=complete("messages:types"))
@click.argument("values", nargs=-1, shell_complete=complete("messages:prototypes"))
@click.option("-r", "--rate", type=rate_option, help="Publish so many times a second until Ctrl-C.")
@click.option("-1", "--once", is_flag=True, help="Publish once, or the first of several, and end.")
@click.option(
    "-t", "--times", metavar="N", type=whole_number(1), help="Publish N times and end; 1 Hz or -r."
)
@click.option(
    "-l", "--latch", is_flag=True, help="Stay, and send the last message to each new subscriber."
)
@click.option(
    "-f", "--file", type=click.Path(), help="Read messages from a file ('-': standard input)."
)
@click.option(
    "-w",
    "--wait-subscribers",
    "--wait-matching-subscriptions",
    "subscribers",
    metavar="N",
    type=whole_number(0),
    help="Wait until N nodes subscribe, before the first message.",
)
@click.option(
    "--timeout",
    "--max-wait",
    "--max-wait-time-secs",
    type=duration,
    help="Give up (exit code 4) when they take longer.",
)
@click.option(
    "--keep-alive", type=duration, help="Stay so long after the last message, latching it."
)
@click.option("-v", "--verbose", is_flag=True, help="Tell of every message on standard error.")
@click.option(
    "-s",
    "--substitute-keywords",
    is_flag=True,
    help="As rostopic: stamp each message anew. It is always done.",
)
@click.option(
    "--use-rostime", "--use-sim-time", "simulated", is_flag=True, help="Take stamps from /clock."
)
@click.option("--literal", is_flag=True, help="TOPIC is the LCM channel, to the letter.")
@click.option(
    "--ns",
    metavar="NAME",
    help="The namespace that TOPIC stands in; as __ns:=NAME.",
    shell_complete=complete("bus:namespaces"),
)
@click.option(
    "-n", "--name", "--node-name", metavar="NAME", help="The name of this node; as __name:=NAME."
)
@click.option(
    "--remap",
    metavar="FROM:=TO",
    multiple=True,
    help="Another topic in place of FROM.",
    shell_complete=complete("programs:remaps"),
)
@bus_options
def command(  # noqa: PLR0913 - one parameter an option
    topic: str,
    type_: str,
    values: tuple[str, ...],
    *,
    rate: float | None,
    once: bool,
    times: int | None,
    latch: bool,
    file: str | None,
    subscribers: int | None,
    timeout: float | None,
    keep_alive: float | None,
    verbose: bool,
    substitute_keywords: bool,
    simulated: bool,
    literal: bool,
    ns: str | None,
    name: str | None,
    remap: tuple[str, ...],
) -> None:
    """Publish messages on a topic; VALUES are YAML or JSON, as rostopic takes them.

    One value that is a dict names fields; otherwise values are the fields in order. Fields that
    are left out keep their defaults. A time may be "now", and a header "auto": each message is
    stamped when it is sent. Without -r, -1 and -t the message is sent once and again to each
    subscriber that appears, until Ctrl-C. While the network is gone, what repeats waits for it.

    The first message waits up to a second for a subscriber, or for as many as -w says. -1 ends at
    once after that; to stay three seconds longer, as rostopic does, add --keep-alive 3s.

    Several messages stand in a file (-f) with a line of --- between them, as echo prints them, or
    as JSON. A file is checked before anything is sent, and goes at 10 Hz or -r; one message is
    repeated. In place of VALUES, "-" is standard input: each message goes as soon as it is whole.

    \b
    Examples:
      lcmtools pub /chatter std_msgs/String "data: hello"
      lcmtools pub -r 10 cmd_vel geometry_msgs/Twist "{linear: [0.5, 0, 0], angular: [0, 0, 0.3]}"
      lcmtools pub -1 /goal geometry_msgs/PoseStamped "{header: auto, pose: {position: {x: 1}}}"
      lcmtools pub -1 -w 2 --timeout 10s /start std_msgs/Empty
      lcmtools echo --json /odom | lcmtools pub /odom_copy nav_msgs/Odometry -
    """  # noqa: D301 - \b is click's mark
    del substitute_keywords  # stamps are always set anew
    _check_options(rate=rate, once=once, times=times)
    _check_topic(topic, literal=literal)
    wanted = _wanted(subscribers, timeout, is_counted=once or bool(times), simulated=simulated)
    flags = {"--ns": [ns], "--name": [name], "--remap": remap}
    said = [f"{flag}={value}" for flag, given in flags.items() for value in given if value]
    names, words = split_arguments([*said, *values])
    kind = message_class(type_)
    if ends_in_one() and not (words or file) and fields(kind):
        raise UsageError("-1 may mean the option or the value", "write --once, or -- -1")
    wish = PublishOptions(rate, 1 if once else times, once, latch, keep_alive)
    incoming = read_incoming(kind, words, file)
    pace = wish.pace(incoming)
    with own_node(names, simulated=simulated) as node:
        publisher = node.create_publisher(kind, topic, literal=literal)
        audience = SubscriberWait(node, publisher, chosen_url())
        if simulated:
            wait_for_clock(node, timeout)
        audience.wait(wanted)
        sender = Sender(
            node,
            publisher,
            latches=pace.stay > 0 or latch,
            is_verbose=verbose,
            endures=pace.is_endless or incoming.is_stream or pace.stay > 0,
        )
        if pace.stay == math.inf:
            talk("publishing and latching message. Press ctrl-C to terminate")
        elif pace.is_endless and not rate:
            talk(f"publishing the one message {pace.rate:g} times a second, until Ctrl-C")
        send_all(sender, pace.drafts(incoming), pace)


def _check_options(*, rate: float | None, once: bool, times: int | None) -> None:
    if rate is not None and once:
        raise UsageError("-r and -1 exclude each other", "use one of them")
    if times is not None and once:
        raise UsageError("-t and -1 exclude each other", "use one of them")


def _check_topic(topic: str, *, literal: bool) -> None:
    """Refuse what no node could announce; the rest is the naming rules' business."""
    if not literal and not topic.strip("/ "):
        raise UsageError("the topic's name is empty", "give one, for example /chatter")
    if any("\ud800" <= character <= "\udfff" for character in topic):
        raise UsageError(f"{topic!a} is not UTF-8", "nodes can name no other channel")


def _wanted(
    subscribers: int | None, timeout: float | None, *, is_counted: bool, simulated: bool
) -> Wanted:
    """Whom to wait for; with --timeout, -1 and -t wait for one, as with ros2."""
    if timeout is not None and subscribers is None and is_counted:
        return Wanted(1, timeout)
    if timeout is not None and subscribers is None and not simulated:
        raise UsageError("--timeout is how long to wait for subscribers", "say how many by -w N")
    return Wanted(subscribers, timeout)
