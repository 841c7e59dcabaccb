"""A node, or a program that is not a node, as lines of text and as values for JSON."""

import socket
import time
from collections.abc import Iterator, Sequence
from itertools import chain

from lcmtools.bus.kernel import receive_buffers
from lcmtools.bus.processes import usage_of
from lcmtools.graph.command_line import LONGEST_COMMAND, shortened
from lcmtools.graph.drawing.labels import printable
from lcmtools.graph.model import Endpoint, Graph, Node, Role
from lcmtools.names import is_hidden
from lcmtools.observe.measuring.counters import average_rate, callback_record, callback_times
from lcmtools.observe.node_requests import program_place
from lcmtools.observe.reading.senders import Program, is_here, user_name
from lcmtools.observe.reports.describe import (
    Kinds,
    callback_errors,
    candidates_text,
    host_text,
    kinds_text,
    node_record,
    seen_kinds,
    types_record,
)

_TITLES = {
    Role.PUBLISHER: "Publications",
    Role.SUBSCRIBER: "Subscriptions",
    Role.SERVICE: "Services",
    Role.CLIENT: "Service clients",
}


def listed(node: Node, now: int) -> str:
    """Return a node as in rosnode list -a: first the address, and after the name its state."""
    seconds = _up_time(node, now)
    units = (("days", 86400), ("h", 3600), ("min", 60))
    spans = (f"{seconds / length:.1f} {unit}" for unit, length in units if seconds >= 2 * length)
    state = f"stale: {node.stale}" if node.stale else f"up {next(spans, f'{seconds:.0f} s')}"
    behind = f", on {node.bus}" if node.path else ""
    return f"{node.host}:{node.pid} \t{node.name}\t{state}{behind}"


def roles(node: Node, *, show_hidden: bool) -> list[str]:
    """Return its name, and its publications, subscriptions, services and clients, with types."""
    rows = ["-" * 80, f"Node [{node.name}]"]
    for role, title in _TITLES.items():
        shown = [
            f" * {e.topic} [{' or '.join(e.types) or kinds_text(_observed(e), e.topic)}]{_dropped(e)}"
            for e in node.having(role)
            if show_hidden or not is_hidden(e.topic)
        ]
        if shown:
            rows += [f"{title}: ", *shown, ""]
        elif role is not Role.CLIENT:  # rosnode has no such section
            rows += [f"{title}: None", ""]
    return [*rows, ""]


def process(node: Node, now: int) -> list[str]:
    """Return its place, start time, use of resources, and callback errors."""
    rows = [f"Host: {host_text(node)}", f"Pid: {node.pid}", f"Command: {node.command}"]
    if node.stale:
        rows.append(f"Stale: {node.stale}")
    else:
        rows += _usage(node.pid, now) if is_here(node) else []
        seconds = _up_time(node, now)
        rows.append(f"Up for: {seconds:.0f} s")
        rows.append(f"In callbacks: {_percent(node.busy / 1e9, seconds)} of that time")
    errors = [f" * {printable(text)}" for text in callback_errors(node)]
    return [*rows, "Errors of callbacks:", *errors] if errors else rows


def counters(node: Node) -> list[str]:
    """Return the number of messages, average rate and drops of each topic."""
    rows = [_counter(node, endpoint) for endpoint in _ends(node)]
    return ["Counters:", *rows] if rows else []


def connections(node: Node, graph: Graph) -> list[str]:
    """Return the other nodes that its topics connect it to."""
    rows = [
        row
        for topic, direction, peer in _peers(node, graph)
        for row in (f" * topic: {topic}", f"    * {direction}: {peer}")
    ]
    return ["Connections:", *(rows or [" * none"]), ""]


def record(node: Node, graph: Graph, now: int) -> dict[str, object]:
    """Return all of these for JSON."""
    taken = usage_of(node.pid) if is_here(node) and not node.stale else None
    return {
        **node_record(node),
        **{
            title.lower().replace(" ", "_"): list(map(_endpoint_record, node.having(role)))
            for role, title in _TITLES.items()
        },
        "connections": [
            dict(zip(("topic", "direction", "node"), one, strict=True))
            for one in _peers(node, graph)
        ],
        "up_time": None if node.stale else _up_time(node, now),
        "callback_time": node.busy,
        "callback_errors": [error._asdict() for error in reversed(node.errors)],
        "user": user_name(taken.uid) if taken else None,
        "memory_bytes": taken.memory_bytes if taken else None,
        "processor_time": taken.processor_time if taken else None,
    }


def ping_reply(node: Node, seconds: float) -> str:
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


def _usage(pid: int, now: int) -> list[str]:
    """The resources that a process of this computer uses, if the system shows them."""
    taken = usage_of(pid)
    if taken is None:
        return []
    started = time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(taken.start_time / 1e9))
    share = _percent(taken.processor_time, (now - taken.start_time) / 1e9)
    return [
        f"User: {user_name(taken.uid)}",
        f"Started: {started}",
        f"Memory: {taken.memory_bytes / 1e6:.1f} MB",
        f"Processor: {share} of a core since it started",
    ]


def _up_time(node: Node, now: int) -> float:
    return max(0.0, (node.time_there(now) - node.start_time) / 1e9)


def _counter(node: Node, endpoint: Endpoint) -> str:
    verb = "sent" if endpoint.role is Role.PUBLISHER else "received"
    rate, took = average_rate(node, endpoint), callback_times(endpoint)
    average = "" if rate is None else f", {rate:.3g} Hz on average"
    counted = f"{endpoint.messages} {verb}, {endpoint.bytes} bytes{average}{_dropped(endpoint)}"
    return f" * {endpoint.topic}: {counted}{f', {took}' if took else ''}"


def _dropped(endpoint: Endpoint) -> str:
    return f", {endpoint.drops} dropped" if endpoint.drops else ""


def _ends(node: Node) -> tuple[Endpoint, ...]:
    return node.having(Role.PUBLISHER) + node.having(Role.SUBSCRIBER)


def _peers(node: Node, graph: Graph) -> Iterator[tuple[str, str, str]]:
    """A topic, the direction of its messages, and another node with it."""
    for endpoint in _ends(node):
        topic = graph.topic(endpoint.topic)
        outbound = endpoint.role is Role.PUBLISHER
        for peer, _ in topic.subscribers if outbound else topic.publishers:
            if peer.id != node.id:
                yield topic.name, "to" if outbound else "from", peer.name


def _percent(spent: float, seconds: float) -> str:
    return f"{100 * spent / max(1e-9, seconds):.1f} %"


def _endpoint_record(endpoint: Endpoint) -> dict[str, object]:
    return {
        "topic": endpoint.topic,
        "types": list(endpoint.types or chain(*_observed(endpoint))),
        "depth": endpoint.depth,
        "messages": endpoint.messages,
        "bytes": endpoint.bytes,
        "drops": endpoint.drops,
        **callback_record(endpoint),
    }


def listed_program(program: Program) -> list[str]:
    """Return a program as ``node list -a`` shows it: its place, command and role."""
    user = f" (user {program.user})" if program.user else ""
    parts = [f"publishes {', '.join(program.channels)}"] if program.channels else []
    if program.listens:
        lost = sum(row.drops for row in program.sockets)
        parts.append(f"listens ({lost} datagrams dropped so far)" if lost else "listens")
    return [f"{program_place(program)} \t{command_text(program)}{user}", f"\t{', '.join(parts)}"]


def program_rows(program: Program, now: int, *, quiet: bool) -> list[str]:
    """Return a program as ``node info`` shows it."""
    rows = ["-" * 80, f"Program [{command_text(program)}] (no node: seen on the bus only)"]
    types = {
        s.channel: kinds_text(seen_kinds(s.fingerprints, s.channel), s.channel)
        for s in program.traffic
    }
    rows.append("Publications: " if types else "Publications: none seen")
    rows += [f" * {channel} [{text}]" for channel, text in types.items()]
    listens = {True: "on unknown channels", False: "None", None: "not known"}
    rows += ["", f"Subscriptions: {listens[program.listens]}", "", ""]
    if quiet:
        return rows
    rows.append(f"Host: {program_place(program).rpartition(':')[0]}")
    if process := program.process:
        rows += [f"Pid: {process.pid}", f"Command: {process.command}", *_usage(process.pid, now)]
    sizes = receive_buffers() if program.sockets else {}
    rows += [
        f"Buffer: {_kilobytes(row.queued_bytes)} of {_kilobytes(sizes.get(row.inode))} wait,"
        f" {row.drops} datagrams dropped"
        for row in program.sockets
    ]
    return [*rows, f"Ports: {', '.join(map(str, program.ports)) or 'none seen'}", ""]


def program_record(program: Program) -> dict[str, object]:
    """Return a program for JSON, with the keys of a node that are known."""
    process = program.process
    return {
        "observed": True,
        "node": None,
        "host": socket.gethostname() if process else None,
        "address": program.address or None,
        "ports": list(program.ports),
        "pid": process.pid if process else None,
        "command": process.command if process else None,
        "user": program.user or None,
        "publications": [
            {
                "topic": seen.channel,
                **types_record(seen_kinds(seen.fingerprints, seen.channel), seen.channel),
                "messages": seen.messages,
                "bytes": seen.bytes,
                "rate": seen.rate(),
            }
            for seen in program.traffic
        ],
        "listens": program.listens,
        "queued_bytes": sum(row.queued_bytes for row in program.sockets),
        "drops": sum(row.drops for row in program.sockets),
        "candidates": [process.pid for process in program.candidates],
    }


def command_text(program: Program) -> str:
    """Return a program's name and arguments, as far as the system knows."""
    if program.process:
        return shortened(program.process.command, LONGEST_COMMAND)
    return f"a program{candidates_text(program.candidates)}"


def _observed(end: Endpoint) -> Kinds:
    """Return the types of a node's messages that are only observed, as of a plain program."""
    return seen_kinds(end.fingerprints, end.topic)


def _kilobytes(size: int | None) -> str:
    return "an unknown size" if size is None else f"{size / 1e3:.0f} kB"
