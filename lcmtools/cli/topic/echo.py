"""``lcmtools echo``."""

import click

from lcmtools.cli.find import ask_nodes
from lcmtools.cli.options import (
    CONTEXT,
    bus_options,
    duration,
    json_option,
    open_watch,
    topic_spellings,
    whole_number,
)
from lcmtools.cli.output import data
from lcmtools.cli.topic.payload import Decoder
from lcmtools.cli.topic.shown import Shower, look
from lcmtools.cli.topic.stream import Stream
from lcmtools.messages.view import Hidden


@click.command("echo", context_settings=CONTEXT)
@click.argument("topic")
@click.option("-n", "count", metavar="N", type=whole_number(1), help="Stop after so many messages.")
@click.option("-1", "--once", is_flag=True, help="Stop after one message.")
@click.option("--timeout", type=duration, help="Give up (exit code 4) when none comes so long.")
@click.option(
    "--field", "fields", metavar="PATH", multiple=True, help="Show this field; may be repeated."
)
@click.option("--filter", "condition", metavar="EXPR", help="Show messages for which this is true.")
@click.option("--noarr", is_flag=True, help="Show only type and length of arrays.")
@click.option("--nostr", is_flag=True, help="Show only the length of strings.")
@click.option("-p", "--csv", "as_csv", is_flag=True, help="Print comma-separated values.")
@click.option("--flow-style", "as_flow", is_flag=True, help="Print each message in one line.")
@click.option("--raw", is_flag=True, help="Print the payload in hexadecimal.")
@json_option
@bus_options
def command(  # noqa: PLR0913 - one parameter an option
    topic: str,
    *,
    count: int | None,
    once: bool,
    timeout: float | None,
    fields: tuple[str, ...],
    condition: str | None,
    noarr: bool,
    nostr: bool,
    as_csv: bool,
    as_flow: bool,
    raw: bool,
    as_json: bool,
) -> None:
    """Print the messages of a topic as they come, as rostopic does.

    TOPIC may end in a field's path: dots or slashes, [0] or [0:5] for arrays. In --filter, m is the
    message; there are comparisons, arithmetic, and, or, not, in, and functions as len and hypot.
    A message of an unknown type is shown in hexadecimal. With --json each is one line.

    \b
    Examples:
      lcmtools echo /husky0/odometry
      lcmtools echo /husky0/odometry/pose.pose.position --csv
      lcmtools echo /scan/ranges[0:5] -n 1 --timeout 5s
      lcmtools echo /scan --field header.stamp --field ranges[::90]
      lcmtools echo /chatter --filter "m.data == 'hello'"
      lcmtools echo /joint_states --filter "len(position) > 2 and abs(position[0]) < 0.1"
      lcmtools echo EXAMPLE --noarr
    """  # noqa: D301 - \b is click's mark
    flags = {"--json": as_json, "--csv": as_csv, "--flow-style": as_flow, "--raw": raw}
    wanted = look(flags, fields, condition, Hidden(noarr, nostr))
    limit = 1 if once else count
    topic_spellings(topic)  # an empty name is wrong whatever the bus is
    with open_watch("echo") as watch:
        ask_nodes(watch)
        stream = Stream(watch, topic)
        wanted.check(stream.types, stream.path)
        shower = Shower(Decoder(watch), wanted)
        for shown, text in enumerate(stream.texts(shower.show, timeout), 1):
            data(text)
            if shown == limit:
                return
