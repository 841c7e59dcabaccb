"""The sections of ``lcmtools node info``; and programs that are no nodes."""

import socket
import time
from collections.abc import Iterator

from lcmtools.bus.kernel import receive_buffers
from lcmtools.bus.processes import usage_of
from lcmtools.graph.model import Endpoint, Graph, Node, Role, Traffic
from lcmtools.messages.registry import candidates
from lcmtools.names import is_hidden
from lcmtools.observe.counters import callback_record, callback_times
from lcmtools.observe.describe import UNKNOWN, candidates_text, host_text
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
        shown = [e for e in node.having(role) if show_hidden or not is_hidden(e.topic)]
        if shown:
            rows += [f"{title}: ", *(f" * {_endpoint_text(endpoint)}" for endpoint in shown), ""]
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
    share = _share(node.busy / 1e9, seconds)
    return [*rows, f"Up for: {seconds:.0f} s", f"In callbacks: {share:.1f} % of that time"]


def usage(pid: int, now: int) -> list[str]:
    """Return the resources that a process of this computer uses, where the system knows."""
    taken = usage_of(pid)
    if taken is None:
        return []
    started = time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(taken.start_time / 1e9))
    share = _share(taken.processor_time, (now - taken.start_time) / 1e9)
    return [
        f"User: {user_name(taken.uid)}",
        f"Started: {started}",
        f"Memory: {taken.memory_bytes / 1e6:.1f} MB",
        f"Processor: {share:.1f} % of a core since it started",
    ]


def counters(node: Node) -> list[str]:
    """Return each topic's messages, their average rate, and drops."""
    rows = [_counter(node, endpoint) for endpoint in _ends(node)]
    return ["Counters:", *rows] if rows else []


def connections(node: Node, graph: Graph) -> list[str]:
    """Return the other nodes at the other ends of its topics."""
    rows = []
    for endpoint, direction, peers in _peers(node, graph):
        for peer in peers:
            rows += [f" * topic: {endpoint.topic}", f"    * {direction}: {peer}"]
    return ["Connections:", *(rows or [" * none"])]


def record(node: Node, graph: Graph, now: int) -> dict[str, object]:
    """Return all of it for JSON."""
    taken = usage_of(node.pid) if is_here(node) and not node.stale else None
    return {
        "publications": [_endpoint_record(e) for e in node.having(Role.PUBLISHER)],
        "subscriptions": [_endpoint_record(e) for e in node.having(Role.SUBSCRIBER)],
        "services": [_endpoint_record(e) for e in node.having(Role.SERVICE)],
        "service_clients": [_endpoint_record(e) for e in node.having(Role.CLIENT)],
        "connections": [
            {"topic": endpoint.topic, "direction": direction, "node": peer}
            for endpoint, direction, peers in _peers(node, graph)
            for peer in peers
        ],
        "up_time": None if node.stale else _up_time(node, now),
        "callback_time": node.busy,
        "user": user_name(taken.uid) if taken else None,
        "memory_bytes": taken.memory_bytes if taken else None,
        "processor_time": taken.processor_time if taken else None,
    }


def _up_time(node: Node, now: int) -> float:
    return max(0.0, (node.time_there(now) - node.start_time) / 1e9)


def _endpoint_text(endpoint: Endpoint) -> str:
    types = " or ".join(endpoint.types) or "unknown type"
    drops = f", {endpoint.drops} dropped" if endpoint.drops else ""
    return f"{endpoint.topic} [{types}]{drops}"


def _counter(node: Node, endpoint: Endpoint) -> str:
    verb = "sent" if endpoint.role is Role.PUBLISHER else "received"
    seconds = (endpoint.last_time - node.start_time) / 1e9
    parts = [f"{endpoint.messages} {verb}", f"{endpoint.bytes} bytes"]
    if endpoint.messages > 1 and seconds > 0:
        parts.append(f"{endpoint.messages / seconds:.3g} Hz on average")
    if endpoint.drops:
        parts.append(f"{endpoint.drops} dropped")
    if took := callback_times(endpoint):
        parts.append(took)
    return f" * {endpoint.topic}: {', '.join(parts)}"


def _ends(node: Node) -> tuple[Endpoint, ...]:
    return node.having(Role.PUBLISHER) + node.having(Role.SUBSCRIBER)


def _peers(node: Node, graph: Graph) -> Iterator[tuple[Endpoint, str, list[str]]]:
    for endpoint in _ends(node):
        topic = graph.topic(endpoint.topic)
        outbound = endpoint.role is Role.PUBLISHER
        peers = topic.subscribers if outbound else topic.publishers
        names = [peer.name for peer, _ in peers if peer.id != node.id]
        yield endpoint, "to" if outbound else "from", names


def _share(spent: float, seconds: float) -> float:
    return 100 * spent / max(1e-9, seconds)


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
    published = {
        seen.channel: f" * {seen.channel} [{_type_text(seen)}]" for seen in program.traffic
    }
    rows += ["Publications: ", *published.values()] if published else ["Publications: none seen"]
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
