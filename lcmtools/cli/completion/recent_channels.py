"""Channels of the last minute, remembered from one completion to the next.

Nodes answer a probe. Any other program shows only if it publishes while a completion listens, which
is unlikely at 1 Hz; with this, the next completion still offers its channel.
"""

import contextlib
import json
from collections.abc import Mapping
from pathlib import Path

from lcmtools.folders import runtime_folder, write_atomically
from lcmtools.graph.model import Graph, Role, Traffic

KEPT = 60_000_000_000  # the time that a channel is remembered [ns]
_MOST = 1000  # channels


def with_recent_channels(graph: Graph, bus: str, environment: Mapping[str, str]) -> Graph:
    """Return the graph with the channels seen before; remember those seen now."""
    folder = runtime_folder(environment)
    if folder is None:
        return graph
    path = folder / "heard" / f"{bus}.json"
    known = {one.channel: one for one in _read(path) if 0 <= graph.time - one.last_time < KEPT}
    announced = {end.topic for node in graph.nodes for end in node.having(Role.PUBLISHER)}
    foreign = {one.channel: one for one in graph.traffic if one.channel not in announced}
    if foreign:
        with contextlib.suppress(OSError):
            _write(path, {**known, **foreign})
    more = [one for channel, one in known.items() if channel not in foreign]
    return graph._replace(traffic=(*graph.traffic, *more))


def _read(path: Path) -> list[Traffic]:
    try:
        rows = json.loads(path.read_text(encoding="utf-8"))
        return [
            Traffic(str(channel), None, tuple(map(int, fingerprints)), 1, 0, int(last), int(last))
            for channel, fingerprints, last in rows
        ]
    except (OSError, ValueError, TypeError):
        return []


def _write(path: Path, seen: Mapping[str, Traffic]) -> None:
    latest = sorted(seen.values(), key=lambda one: one.last_time)[-_MOST:]
    rows = [[one.channel, one.fingerprints, one.last_time] for one in latest]
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    write_atomically(path, json.dumps(rows), private=True)
