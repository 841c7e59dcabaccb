"""Channels that were heard in the last minute: remembered from one completion to the next.

Nodes answer when they are asked. A program that knows nothing of lcmtools has to be heard, and what
it publishes once a second will hardly come while a completion listens; but it is there a moment
later, when the next one asks.
"""

import contextlib
import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from lcmtools.cli.completion.places import runtime_folder, write_atomically
from lcmtools.graph.model import Graph, Role, Traffic

KEPT = 60_000_000_000
"""How long a channel is remembered [ns]."""
_MOST = 1000  # channels


def with_heard(graph: Graph, bus: str, environment: Mapping[str, str]) -> Graph:
    """The graph with the channels heard before; what is heard now is remembered."""
    folder = runtime_folder(environment)
    if folder is None:
        return graph
    path = folder / "heard" / f"{bus}.json"
    known = {one.channel: one for one in _read(path) if 0 <= graph.time - one.last_time < KEPT}
    foreign = {one.channel: one for one in graph.traffic if one.channel not in _announced(graph)}
    if foreign:
        with contextlib.suppress(OSError):
            _write(path, {**known, **foreign})
    more = [one for channel, one in known.items() if channel not in foreign]
    return replace(graph, traffic=(*graph.traffic, *more))


def _announced(graph: Graph) -> set[str]:
    return {
        endpoint.topic
        for node in graph.nodes
        for endpoint in node.endpoints
        if endpoint.role is Role.PUBLISHER
    }


def _read(path: Path) -> list[Traffic]:
    try:
        rows = json.loads(path.read_text(encoding="utf-8"))
        return [
            Traffic(str(channel), None, tuple(map(int, fingerprints)), 1, 0, int(last), int(last))
            for channel, fingerprints, last in rows
        ]
    except (OSError, ValueError, TypeError):
        return []


def _write(path: Path, heard: Mapping[str, Traffic]) -> None:
    latest = sorted(heard.values(), key=lambda one: one.last_time)[-_MOST:]
    rows = [[one.channel, one.fingerprints, one.last_time] for one in latest]
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    write_atomically(path, json.dumps(rows), private=True)
