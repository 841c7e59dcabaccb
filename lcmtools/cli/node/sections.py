"""The sections of ``lcmtools node info``; and programs that are no nodes."""

import socket
import time
from collections.abc import Iterator
from dataclasses import asdict

from lcmtools.bus.kernel import receive_buffers
from lcmtools.bus.processes import usage_of
from lcmtools.graph.drawing.labels import printable
from lcmtools.graph.model import Endpoint, Graph, Node, Role, Traffic
from lcmtools.messages.registry import candidates
from lcmtools.names import is_hidden
from lcmtools.observe.counters import callback_record, callback_times
from lcmtools.observe.describe import UNKNOWN, callback_errors, candidates_text, host_text
from lcmtools.observe.nodes import program_place
from lcmtools.observe.senders import Program, is_here, user_name

_TITLES = {
    Role.PUBLISHER: "Publications",
    Role.SUBSCRIBER: "Subscriptions",
    Role.SERVICE: "Services",
    Role.CLIENT: "Service clients",
}


def roles(node: Node, *, show_hidden: bool) -> list[str]:
    """Return its publications, subscriptions, services and clients, with types."""
    rows = []
    for role, title in _TITLES.items():
        shown = [
            f" * {e.topic} [{' or '.join(e.types) or UNKNOWN}]{_dropped(e)}"
            for e in node.having(role)
            if show_hidden or not is_hidden(e.topic)
        ]
        if shown:
            rows += [f"{title}: ", *shown, ""]
        elif role is not Role.CLIENT:  # rosnode has no such section
            rows += [f"{title}: None", ""]
    return rows


def process(node: Node, now: int) -> list[str]:
    """Return where it runs, since when, and on this computer its use of resources."""
    rows = [f"Host: {host_text(node)}", f"Pid: {node.pid}", f"Command: {node.command}"]
    if node.stale:
        return [*rows, f"Stale: {node.stale}"]
    rows += usage(node.pid, now) if is_here(node) else []
    seconds = _up_time(node, now)
    rows.append(f"Up for: {seconds:.0f} s")
    return [*rows, f"In callbacks: {_percent(node.busy / 1e9, seconds)} of that time"]


def usage(pid: int, now: int) -> list[str]:
    """Return the resources that a process of this computer uses, where the system knows."""
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


def errors(node: Node) -> list[str]:
    """Return what its callbacks have raised, the newest first."""
    rows = [f" * {printable(text)}" for text in callback_errors(node)]
    return ["Errors of callbacks:", *rows] if rows else []


def counters(node: Node) -> list[str]:
    """Return each topic's messages, their average rate, and drops."""
    rows = [_counter(node, endpoint) for endpoint in _ends(node)]
    return ["Counters:", *rows] if rows else []


def connections(node: Node, graph: Graph) -> list[str]:
    """Return the other nodes at the other ends of its topics."""
    rows = [
        row
        for topic, direction, peer in _peers(node, graph)
        for row in (f" * topic: {topic}", f"    * {direction}: {peer}")
    ]
    return ["Connections:", *(rows or [" * none"])]


def record(node: Node, graph: Graph, now: int) -> dict[str, object]:
    """Return all of it for JSON."""
    taken = usage_of(node.pid) if is_here(node) and not node.stale else None
    return {
        **{
            title.lower().replace(" ", "_"): list(map(_endpoint_record, node.having(role)))
            for role, title in _TITLES.items()
        },
        "connections": [
            {"topic": topic, "direction": direction, "node": peer}
            for topic, direction, peer in _peers(node, graph)
        ],
        "up_time": None if node.stale else _up_time(node, now),
        "callback_time": node.busy,
        "callback_errors": list(map(asdict, reversed(node.errors))),
        "user": user_name(taken.uid) if taken else None,
        "memory_bytes": taken.memory_bytes if taken else None,
        "processor_time": taken.processor_time if taken else None,
    }


def _up_time(node: Node, now: int) -> float:
    return max(0.0, (node.time_there(now) - node.start_time) / 1e9)


def _counter(node: Node, endpoint: Endpoint) -> str:
    verb = "sent" if endpoint.role is Role.PUBLISHER else "received"
    seconds = (endpoint.last_time - node.start_time) / 1e9
    parts = [f"{endpoint.messages} {verb}", f"{endpoint.bytes} bytes"]
    if endpoint.messages > 1 and seconds > 0:
        parts.append(f"{endpoint.messages / seconds:.3g} Hz on average")
    took = callback_times(endpoint)
    drops = _dropped(endpoint)
    return f" * {endpoint.topic}: {', '.join(parts)}{drops}{f', {took}' if took else ''}"


def _dropped(endpoint: Endpoint) -> str:
    return f", {endpoint.drops} dropped" if endpoint.drops else ""


def _ends(node: Node) -> tuple[Endpoint, ...]:
    return node.having(Role.PUBLISHER) + node.having(Role.SUBSCRIBER)


def _peers(node: Node, graph: Graph) -> Iterator[tuple[str, str, str]]:
    """A topic, the direction of its messages, and another node that has it."""
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
        "types": list(endpoint.types),
        "depth": endpoint.depth,
        "messages": endpoint.messages,
        "bytes": endpoint.bytes,
        "drops": endpoint.drops,
        **callback_record(endpoint),
    }


def program_rows(program: Program) -> list[str]:
    """Return a program as ``node list -a`` shows it: its place, its command, its part."""
    user = f" (user {program.user})" if program.user else ""
    parts = [f"publishes {', '.join(program.channels)}"] if program.channels else []
    if program.listens:
        lost = sum(row.drops for row in program.sockets)
        parts.append(f"listens ({lost} datagrams dropped so far)" if lost else "listens")
    return [f"{program_place(program)} \t{command_text(program)}{user}", f"\t{', '.join(parts)}"]


def program_sections(program: Program, usage: list[str], *, quiet: bool) -> list[str]:
    """Return a program as ``node info`` shows it; ``usage`` is that of its process."""
    rows = ["-" * 80, f"Program [{command_text(program)}] (no node: seen on the bus only)"]
    types = {seen.channel: _type_text(seen) for seen in program.traffic}
    rows.append("Publications: " if types else "Publications: none seen")
    rows += [f" * {channel} [{text}]" for channel, text in types.items()]
    listens = {True: "on unknown channels", False: "None", None: "not known"}
    rows += ["", f"Subscriptions: {listens[program.listens]}", "", ""]
    if quiet:
        return rows
    rows.append(f"Host: {program_place(program).rpartition(':')[0]}")
    if program.process:
        rows += [f"Pid: {program.process.pid}", f"Command: {program.process.command}", *usage]
    sizes = receive_buffers() if program.sockets else {}
    rows += [
        f"Buffer: {_kilobytes(row.queued_bytes)} of {_kilobytes(sizes.get(row.inode))} wait,"
        f" {row.drops} datagrams dropped"
        for row in program.sockets
    ]
    return [*rows, f"Ports: {', '.join(map(str, program.ports)) or 'none seen'}", ""]


def program_record(program: Program) -> dict[str, object]:
    """Return a program for JSON, with the keys of a node where they are known."""
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
                "type": _type_text(seen),
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
    """Return a program's command line, as far as the system knows."""
    if program.process:
        return program.process.command
    return f"a program{candidates_text(program.candidates)}"


def _type_text(seen: Traffic) -> str:
    names = [found[0] for value in seen.fingerprints if (found := candidates(value))]
    return ", ".join(dict.fromkeys(names)) or UNKNOWN


def _kilobytes(size: int | None) -> str:
    return "an unknown size" if size is None else f"{size / 1e3:.0f} kB"
