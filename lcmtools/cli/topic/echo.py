"""``lcmtools echo``."""

import time
from collections.abc import Iterator

import click

from lcmtools.bus.watch import Watch
from lcmtools.cli.find import ask_nodes, known_spelling, near_topic
from lcmtools.cli.options import (
    CONTEXT,
    bus_options,
    duration,
    json_option,
    open_watch,
    topic_spellings,
    whole_number,
)
from lcmtools.cli.output import data, talk
from lcmtools.cli.topic.payload import Decoder
from lcmtools.errors import NothingReceived
from lcmtools.names import is_hidden
from lcmtools.wire.packet import Packet

_PATIENCE = 2.0  # [s] without a message before the person is told what is on the bus


@click.command("echo", context_settings=CONTEXT)
@click.argument("topic")
@click.option("-n", "count", metavar="N", type=whole_number(1), help="Stop after so many messages.")
@click.option("-1", "--once", is_flag=True, help="Stop after one message.")
@click.option("--timeout", type=duration, help="Give up (exit code 4) when none comes so long.")
@json_option
@bus_options
def command(
    topic: str, *, count: int | None, once: bool, timeout: float | None, as_json: bool
) -> None:
    """Print the messages of a topic as they come, as rostopic does.

    A message of an unknown type is shown in hexadecimal. With --json each is one line.

    \b
    Examples:
      lcmtools echo /husky0/odometry
      lcmtools echo EXAMPLE -n 1 --timeout 5s
    """  # noqa: D301 - \b is click's mark
    limit = 1 if once else count
    with open_watch("echo") as watch:
        ask_nodes(watch)
        # only now: what a latching publisher sends to a new listener must not come before
        watch.listen_to(topic_spellings(topic))
        decoder = Decoder(watch)
        show = decoder.as_json if as_json else decoder.as_text
        for shown, packet in enumerate(_messages(watch, topic, timeout), 1):
            data(show(packet))
            if shown == limit:
                return


def _messages(watch: Watch, topic: str, timeout: float | None) -> Iterator[Packet]:
    """The topic's messages; tells the person when it takes long.

    Raises:
        NothingReceived: None came within ``timeout`` seconds.
    """
    wanted = set(topic_spellings(topic))
    last = time.monotonic()
    told = False
    while True:
        packets = _pull(watch, 0.2 if timeout is None else min(0.2, timeout))
        if packets is None:
            return
        for packet in packets:
            if packet.channel in wanted:
                last, told = time.monotonic(), True
                yield packet
        waited = time.monotonic() - last
        if timeout is not None and waited >= timeout:
            raise NothingReceived(
                f"nothing came on {topic} within {timeout:g} s", _situation(watch, topic)
            )
        if not told and waited >= _PATIENCE:
            told = True
            talk(f"lcmtools echo: no message on {topic} yet; {_situation(watch, topic)}")


def _pull(watch: Watch, timeout: float) -> list[Packet] | None:
    """The next packets; None at the end of a log."""
    try:
        return watch.receive(timeout)
    except EOFError:
        return None


def _situation(watch: Watch, topic: str) -> str:
    """What is on the bus instead."""
    graph = watch.graph()
    spelling = known_spelling(graph, topic)
    if spelling is not None:
        publishers = [node.name for node, _ in graph.topic(spelling).publishers]
        if publishers:
            return f"it is published by {', '.join(publishers)}"
    else:
        near = near_topic(graph, topic)
        if near.startswith("did you mean"):
            return near
    seen = [name for name in graph.topic_names() if not is_hidden(name)]
    return f"on the bus: {', '.join(seen[:8])}" if seen else "no topic is on the bus"
