"""``lcmtools node ping``."""

import secrets
import time

import click

from lcmtools.bus.watch import Watch
from lcmtools.cli.find import find_node
from lcmtools.cli.options import (
    CONTEXT,
    bus_options,
    duration,
    json_option,
    open_watch,
    whole_number,
)
from lcmtools.cli.output import data, document
from lcmtools.errors import NothingReceived
from lcmtools.graph.model import Node
from lcmtools.graph.protocol import NODE_CHANNEL, decode_announcement

_PERIOD = 1.0  # [s] between two pings


@click.command("ping", context_settings=CONTEXT)
@click.argument("node")
@click.option("-c", "--count", metavar="N", type=whole_number(1), help="Stop after so many pings.")
@click.option("--timeout", type=duration, default=3.0, help="Wait so long for an answer (else 3s).")
@json_option
@bus_options
def command(node: str, *, count: int | None, timeout: float, as_json: bool) -> None:
    """Ask a node to answer, once a second, and print how long it takes.

    Exits with 4 when the node does not answer.

    \b
    Examples:
      lcmtools node ping simple_controller
      lcmtools node ping -c 3 /morse
    """  # noqa: D301 - \b is click's mark
    times: list[float] = []
    with open_watch("node_ping") as watch:
        target = find_node(watch.settle(foreign=False), node)
        if not as_json:
            data(f"pinging {target.name} with a timeout of {timeout}s")
        try:
            while count is None or len(times) < count:
                times.append(_ping(watch, target, timeout))
                if not as_json:
                    data(f"reply from {target.name} ({target.host})\ttime={times[-1] * 1e3:.6f}ms")
                if len(times) != count:
                    time.sleep(_PERIOD)
        finally:
            _summarise(target, times, as_json=as_json)


def _ping(watch: Watch, node: Node, timeout: float) -> float:
    """The round trip time of one question [s].

    Raises:
        NothingReceived: The node did not answer in time.
    """
    nonce = secrets.randbits(62) | 1
    start = time.monotonic()
    watch.probe(node.name, nonce)
    while (left := start + timeout - time.monotonic()) > 0:
        for packet in watch.receive(left):
            if packet.channel != NODE_CHANNEL:
                continue
            announcement = decode_announcement(packet.payload)
            if announcement and announcement.answers == nonce and announcement.node.id == node.id:
                return time.monotonic() - start
    raise NothingReceived(
        f"{node.name} did not answer within {timeout:g} s",
        f"its process is {node.pid} on {node.host}; lcmtools wtf looks closer",
    )


def _summarise(node: Node, times: list[float], *, as_json: bool) -> None:
    if as_json:
        document({"node": node.name, "times": times})
    elif len(times) > 1:
        data(f"ping average: {sum(times) / len(times) * 1e3:.6f}ms")
