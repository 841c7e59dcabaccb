"""``lcmtools node ping``."""

from itertools import islice

import click

from lcmtools.cli.bus import in_names, open_monitor
from lcmtools.cli.declare import argument, examples, flag, option, subcommand, whole_number
from lcmtools.cli.options import asking_options, json_option, timeout_option
from lcmtools.cli.output import write_data, write_document, write_lines, write_note
from lcmtools.errors import NothingReceived, UsageError
from lcmtools.graph.model import NodeInfo
from lcmtools.observe.node_requests import node_to_ping, ping, pings
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.observe.reports.node_report import ping_reply, ping_summary
from lcmtools.text_table import plural


@subcommand("ping", timeout_option(3.0), json_option, asking_options)
@examples("node ping simple_controller", "node ping --all")
@argument("node", required=False, completer="bus:nodes")
@flag("-a", "--all", "ping_all", help="Ping every node once.")
@option("-c", "--count", metavar="N", type=whole_number(1), help="Stop after N pings.")
def command(
    node: str | None, *, ping_all: bool, count: int | None, timeout: float, as_json: bool
) -> int:
    """Probe a node once a second, and print its response time.

    The exit code is 4 if a node does not answer.
    """
    if node is None and not ping_all:
        raise click.MissingParameter(param_hint="'NODE'", param_type="argument")
    if ping_all and node is not None:
        raise UsageError("--all cannot be used with a node's name", "leave out one of them")
    if ping_all and count is not None:
        raise UsageError("-c cannot be used with --all", "every node is pinged once")
    with open_monitor("node_ping") as monitor:
        graph = monitor.settle(foreign=False)
        if node is None:
            nodes = [one for one in graph.nodes if not one.is_hidden]
            return _ping_all(monitor, nodes, timeout, as_json=as_json)
        found = node_to_ping(monitor, graph, in_names(node))
        _ping_one(monitor, found, count, timeout, as_json=as_json)
    return 0


def _ping_one(
    monitor: BusMonitor, node: NodeInfo, count: int | None, timeout: float, *, as_json: bool
) -> None:
    """Ping a node repeatedly, and print a summary, also after Ctrl-C."""
    times: list[float] = []
    if not as_json:
        write_data(f"pinging {node.name} with a timeout of {timeout}s")
    try:
        run = node.id
        for found, seconds in islice(pings(monitor, node, timeout), count):
            times.append(seconds)
            if found.id != run:
                run = found.id
                write_note(
                    f"{node.name} was started anew, with pid {found.pid}", "lcmtools node ping"
                )
            if not as_json:
                write_lines([ping_reply(found, seconds)])
    finally:
        if as_json:
            average = sum(times) / len(times) if times else None
            low, high = min(times, default=None), max(times, default=None)
            spread = {"min": low, "average": average, "max": high}
            write_document({"node": node.name, "times": times, **spread})
        else:
            write_lines(ping_summary(times))


def _ping_all(monitor: BusMonitor, nodes: list[NodeInfo], timeout: float, *, as_json: bool) -> int:
    if not nodes:
        write_note(f"no nodes on {monitor.url}")
    if nodes and not as_json:
        write_lines(["Will ping the following nodes: ", *(f" * {node.name}" for node in nodes), ""])
    times: list[float | None] = []
    try:
        times.extend(_try(monitor, node, timeout, as_json=as_json) for node in nodes)
    finally:
        answered = [seconds for seconds in times if seconds is not None]
        if as_json:
            pairs = zip(nodes, times, strict=False)
            write_document([{"node": one.name, "time": seconds} for one, seconds in pairs])
        elif nodes:
            write_lines(
                [
                    f"{len(answered)} of {plural(len(nodes), 'node')} answered",
                    *ping_summary(answered),
                ]
            )
    return 0 if len(answered) == len(nodes) else NothingReceived.exit_code


def _try(monitor: BusMonitor, node: NodeInfo, timeout: float, *, as_json: bool) -> float | None:
    """Ping a node once and print the result. Return the seconds, or None without an answer."""
    if not as_json:
        write_data(f"pinging {node.name} with a timeout of {timeout}s")
    try:
        seconds = ping(monitor, node, timeout)
    except NothingReceived as error:
        write_note(str(error), "lcmtools node ping")
        return None
    if not as_json:
        write_lines([ping_reply(node, seconds)])
    return seconds
