"""``lcmtools node ping``."""

import secrets
import time

import click

from lcmtools.cli.completion.completer import complete
from lcmtools.cli.options import (
    CONTEXT,
    bus_options,
    duration,
    json_option,
    open_monitor,
    whole_number,
)
from lcmtools.cli.output import data, document, lines, talk
from lcmtools.errors import NothingReceived, UsageError
from lcmtools.graph.model import Node, Staleness
from lcmtools.graph.protocol import NODE_CHANNEL, decode_announcement
from lcmtools.observe.find import find_node
from lcmtools.observe.monitor import BusMonitor

_PERIOD = 1.0  # [s] between two pings


@click.command("ping", context_settings=CONTEXT)
@click.argument("node", required=False, shell_complete=complete("bus:nodes"))
@click.option("-a", "--all", "ping_all", is_flag=True, help="Ping every node once.")
@click.option("-c", "--count", metavar="N", type=whole_number(1), help="Stop after so many pings.")
@click.option("--timeout", type=duration, default=3.0, help="Wait so long for an answer (else 3s).")
@json_option
@bus_options
def command(
    node: str | None, *, ping_all: bool, count: int | None, timeout: float, as_json: bool
) -> int:
    """Ask a node to answer, once a second, and print how long it takes.

    Exits with 4 when a node does not answer.

    \b
    Examples:
      lcmtools node ping simple_controller
      lcmtools node ping --all
    """  # noqa: D301 - \b is click's mark
    _check(node, ping_all=ping_all, count=count)
    with open_monitor("node_ping") as monitor:
        graph = monitor.settle(foreign=False)
        if node is None:
            nodes = [one for one in graph.nodes if not one.is_hidden]
            return _ping_all(monitor, nodes, timeout, as_json=as_json)
        _ping_one(monitor, find_node(graph, node), count, timeout, as_json=as_json)
    return 0


def _check(node: str | None, *, ping_all: bool, count: int | None) -> None:
    """Refuse what does not go together.

    Raises:
        click.UsageError: No node is named.
        UsageError: --all is said with a node, or with a count.
    """
    if node is None and not ping_all:
        raise click.MissingParameter(param_hint="'NODE'", param_type="argument")
    if ping_all and node is not None:
        raise UsageError("--all takes no node's name", "leave out one of them")
    if ping_all and count is not None:
        raise UsageError("-c does not go with --all", "every node is pinged once")


def _ping_one(
    monitor: BusMonitor, node: Node, count: int | None, timeout: float, *, as_json: bool
) -> None:
    """Ping a node again and again, and sum up, on Ctrl-C too."""
    times: list[float] = []
    if not as_json:
        data(f"pinging {node.name} with a timeout of {timeout}s")
    try:
        while count is None or len(times) < count:
            times.append(_ping(monitor, node, timeout))
            if not as_json:
                lines([_reply(node, times[-1])])
            if len(times) != count:
                time.sleep(_PERIOD)
    finally:
        if as_json:
            document({"node": node.name, "times": times, **_extremes(times)})
        else:
            lines(_summary(times))


def _ping_all(monitor: BusMonitor, nodes: list[Node], timeout: float, *, as_json: bool) -> int:
    """Ping every node once; the exit code."""
    if not nodes:
        talk(f"no nodes on {monitor.url}")
    if nodes and not as_json:
        lines(["Will ping the following nodes: ", *(f" * {node.name}" for node in nodes), ""])
    times: dict[str, float | None] = {}
    try:
        for node in nodes:
            times[node.id] = _try(monitor, node, timeout, as_json=as_json)
    finally:
        answered = [seconds for seconds in times.values() if seconds is not None]
        if as_json:
            pinged = [node for node in nodes if node.id in times]
            document([{"node": node.name, "time": times[node.id]} for node in pinged])
        elif nodes:
            data(f"{len(answered)} of {len(nodes)} nodes answered")
            lines(_summary(answered))
    return 0 if len(answered) == len(nodes) else NothingReceived.exit_code


def _try(monitor: BusMonitor, node: Node, timeout: float, *, as_json: bool) -> float | None:
    """Ping a node once and say what comes of it; the seconds, None without an answer."""
    if node.stale is Staleness.ENDED:
        talk(f"{node.name} {node.stale}; lcmtools node cleanup forgets it", "lcmtools node ping")
        return None
    if not as_json:
        data(f"pinging {node.name} with a timeout of {timeout}s")
    try:
        seconds = _ping(monitor, node, timeout)
    except NothingReceived as error:
        talk(str(error), "lcmtools node ping")
        return None
    if not as_json:
        lines([_reply(node, seconds)])
    return seconds


def _ping(monitor: BusMonitor, node: Node, timeout: float) -> float:
    """The round trip time of one question [s].

    Raises:
        NothingReceived: The node did not answer in time.
    """
    nonce = secrets.randbits(62) | 1
    monitor.receive(0.0)  # what has come meanwhile is not to be read within the time measured
    start = time.monotonic()
    monitor.probe(node.name, nonce)
    while (left := start + timeout - time.monotonic()) > 0:
        for packet in monitor.receive(left):
            if packet.channel != NODE_CHANNEL:
                continue
            announcement = decode_announcement(packet.payload)
            if announcement and announcement.answers == nonce and announcement.node.id == node.id:
                return time.monotonic() - start
    raise NothingReceived(
        f"{node.name} did not answer within {timeout:g} s",
        f"its process is {node.pid} on {node.host}; lcmtools wtf looks closer",
    )


def _reply(node: Node, seconds: float) -> str:
    return f"reply from {node.name} ({node.host})\ttime={seconds * 1e3:.6f}ms"


def _summary(times: list[float]) -> list[str]:
    """As rosnode ping has it, the average of several; and the shortest and the longest."""
    if len(times) < 2:  # noqa: PLR2004 - one is its own average
        return []
    return [
        f"ping average: {sum(times) / len(times) * 1e3:.6f}ms",
        f"shortest: {min(times) * 1e3:.6f}ms, longest: {max(times) * 1e3:.6f}ms",
    ]


def _extremes(times: list[float]) -> dict[str, float | None]:
    return {
        "min": min(times, default=None),
        "average": sum(times) / len(times) if times else None,
        "max": max(times, default=None),
    }
