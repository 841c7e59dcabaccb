"""A node as lines of text and as values for JSON."""

from collections.abc import Iterator, Sequence

from lcmtools.bus.processes import Process
from lcmtools.graph.drawing.labels import printable
from lcmtools.graph.model import VERSION, Endpoint, Graph, NodeInfo, Role
from lcmtools.names import is_hidden
from lcmtools.observe.measuring.counters import (
    UNCOUNTED,
    callback_json,
    callback_times,
    counted,
    fair_average,
)
from lcmtools.observe.reading.senders import is_here, user_name
from lcmtools.observe.reports import node_list_report
from lcmtools.observe.reports.describe import (
    callback_errors,
    endpoint_types,
    host_text,
    kinds_text,
    seen_kinds,
)
from lcmtools.observe.reports.node_list_report import up_time
from lcmtools.observe.reports.program_report import percent, usage_rows
from lcmtools.text_table import plural

_TITLES = {
    Role.PUBLISHER: "Publications",
    Role.SUBSCRIBER: "Subscriptions",
    Role.SERVICE: "Services",
    Role.CLIENT: "Service clients",
}


def to_lines(
    node: NodeInfo, graph: Graph, now: int, parameters: Sequence[str], *, show_hidden: bool
) -> list[str]:
    """Return all lines of a node, among them those of its parameters."""
    return [
        *roles(node, show_hidden=show_hidden),
        *_process(node, now),
        *parameters,
        *_counters(node),
        *_connections(node, graph),
    ]


def roles(node: NodeInfo, *, show_hidden: bool) -> list[str]:
    """Return its name, and its publications, subscriptions, services and clients, with types."""
    rows = ["-" * 80, f"Node [{node.name}]"]
    for role, title in _TITLES.items():
        shown = [
            f" * {e.topic} [{_types_text(e)}]{_dropped(e)}"
            for e in node.having(role)
            if show_hidden or not is_hidden(e.topic)
        ]
        if shown:
            rows += [f"{title}: ", *shown, ""]
        elif role is not Role.CLIENT:  # rosnode has no such section
            rows += [f"{title}: None", ""]
    return [*rows, ""]


def to_json(node: NodeInfo, graph: Graph, now: int) -> dict[str, object]:
    """Return a node for JSON."""
    taken = Process(node.pid).usage() if is_here(node) and not node.stale else None
    return {
        **node_list_report.to_json(node),
        **{
            title.lower().replace(" ", "_"): list(map(_endpoint_json, node.having(role)))
            for role, title in _TITLES.items()
        },
        "connections": [
            dict(zip(("topic", "direction", "node"), one, strict=True))
            for one in _peers(node, graph)
        ],
        "up_time": None if node.stale else up_time(node, now),
        "callback_time": node.busy if node.is_counted else None,
        "overflows": node.overflows if node.has_details else None,
        "callback_errors": [error._asdict() for error in reversed(node.errors)],
        "protocol_version": node.version,
        "software": node.software or None,
        "has_details": node.has_details,
        "user": user_name(taken.uid) if taken else None,
        "memory_bytes": taken.memory_bytes if taken else None,
        "processor_time": taken.processor_time if taken else None,
    }


def _process(node: NodeInfo, now: int) -> list[str]:
    """Return its place, start time, use of resources, and callback errors."""
    rows = [f"Host: {host_text(node)}", f"Pid: {node.pid}", f"Command: {node.command}"]
    if node.stale:
        rows.append(f"Stale: {node.stale}")
    else:
        rows += usage_rows(Process(node.pid), now) if is_here(node) else []
        seconds = up_time(node, now)
        rows.append(f"Up for: {seconds:.0f} s")
        share = f"{percent(node.busy / 1e9, seconds)} of that time"
        rows.append(f"In callbacks: {share if node.is_counted else 'not known'}")
    if node.overflows:
        rows.append(f"Receive buffer: lost at most {plural(node.overflows, 'datagram')}")
    rows += _version(node)
    errors = [f" * {printable(text)}" for text in callback_errors(node)]
    return [*rows, "Errors of callbacks:", *errors] if errors else rows


def _version(node: NodeInfo) -> list[str]:
    """Return the version that a node speaks, if it is another one than this program's."""
    if node.version == VERSION and node.has_details:
        return []
    software = f" ({node.software})" if node.software else ""
    part = "" if node.has_details else "; of its topics only those that it is seen to publish on"
    return [f"Protocol: version {node.version}{software}, this program's is {VERSION}{part}"]


def _counters(node: NodeInfo) -> list[str]:
    """Return the number of messages, average rate and drops of each topic."""
    rows = [_counter(node, endpoint) for endpoint in _ends(node)]
    return ["Counters:", *rows] if rows else []


def _connections(node: NodeInfo, graph: Graph) -> list[str]:
    """Return the other nodes that its topics connect it to."""
    rows = [
        row
        for topic, direction, peer in _peers(node, graph)
        for row in (f" * topic: {topic}", f"    * {direction}: {peer}")
    ]
    return ["Connections:", *(rows or [" * none"]), ""]


def ping_reply(node: NodeInfo, seconds: float) -> str:
    """Return the line for a node's answer, as in rosnode ping."""
    return f"reply from {node.name} ({node.host})\ttime={seconds * 1e3:.6f}ms"


def ping_summary(times: Sequence[float]) -> list[str]:
    """Return the average of several answers as in rosnode ping, the shortest and the longest."""
    if len(times) < 2:  # noqa: PLR2004 - a single one is its own average
        return []
    return [
        f"ping average: {sum(times) / len(times) * 1e3:.6f}ms",
        f"shortest: {min(times) * 1e3:.6f}ms, longest: {max(times) * 1e3:.6f}ms",
    ]


def _counter(node: NodeInfo, endpoint: Endpoint) -> str:
    if not endpoint.is_counted:
        return f" * {endpoint.topic}: {UNCOUNTED}"
    verb = "sent" if endpoint.role is Role.PUBLISHER else "received"
    rate, took = fair_average(node, endpoint), callback_times(endpoint)
    average = "" if rate is None else f", {rate:.3g} Hz on average"
    counted = f"{endpoint.messages} {verb}, {endpoint.bytes} bytes{average}{_dropped(endpoint)}"
    return f" * {endpoint.topic}: {counted}{f', {took}' if took else ''}"


def _dropped(endpoint: Endpoint) -> str:
    dropped = f", {endpoint.drops} dropped" if endpoint.drops else ""
    return dropped + (f", {endpoint.incomplete} incomplete" if endpoint.incomplete else "")


def _ends(node: NodeInfo) -> tuple[Endpoint, ...]:
    return node.having(Role.PUBLISHER) + node.having(Role.SUBSCRIBER)


def _peers(node: NodeInfo, graph: Graph) -> Iterator[tuple[str, str, str]]:
    """A topic, the direction of its messages, and another node with it."""
    for endpoint in _ends(node):
        topic = graph.topic(endpoint.topic)
        outbound = endpoint.role is Role.PUBLISHER
        for peer, _ in topic.subscribers if outbound else topic.publishers:
            if peer.id != node.id:
                yield topic.name, "to" if outbound else "from", peer.name


def _endpoint_json(endpoint: Endpoint) -> dict[str, object]:
    return {
        "topic": endpoint.topic,
        "types": endpoint_types(endpoint),
        "depth": endpoint.depth,
        **counted(endpoint),
        **callback_json(endpoint),
    }


def _types_text(end: Endpoint) -> str:
    seen = seen_kinds(end.fingerprints, end.topic)  # of a node whose announcement is not readable
    return " or ".join(end.types) or kinds_text(seen, end.topic)
