"""A list of nodes as lines of text, and one of its nodes as values for JSON."""

from collections.abc import Iterable

from lcmtools.graph.model import NodeInfo
from lcmtools.observe.reports.describe import behind_json


def to_lines(nodes: Iterable[NodeInfo], now: int) -> list[str]:
    """Return a line for each node: its address, name and state."""
    return [_row(node, now) for node in nodes]


def to_json(node: NodeInfo) -> dict[str, object]:
    """Return a node, its host and pid, for JSON."""
    return {
        "node": node.name,
        "host": node.host,
        "address": node.sender.address if node.sender else None,
        "pid": node.pid,
        "command": node.command,
        "start_time": node.start_time,
        "stale": node.stale.value or None,
        **behind_json(node),
    }


def up_time(node: NodeInfo, now: int) -> float:
    """Return the time since a node's start [s]."""
    return max(0.0, (node.time_there(now) - node.start_time) / 1e9)


def _row(node: NodeInfo, now: int) -> str:
    """Return a node as in rosnode list -a, and after the name its state."""
    seconds = up_time(node, now)
    units = (("days", 86400), ("h", 3600), ("min", 60))
    spans = (f"{seconds / length:.1f} {unit}" for unit, length in units if seconds >= 2 * length)
    state = f"stale: {node.stale}" if node.stale else f"up {next(spans, f'{seconds:.0f} s')}"
    behind = f", on {node.bus}" if node.path else ""
    return f"{node.host}:{node.pid} \t{node.name}\t{state}{behind}"
