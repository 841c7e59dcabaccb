"""Completers for what is in logs: topics."""

import contextlib
from collections.abc import Iterator
from itertools import islice

from lcmtools.bag.summary import known_nodes
from lcmtools.cli.completion.situation import Candidate, Situation
from lcmtools.errors import LcmtoolsError
from lcmtools.graph.model import Graph, Traffic
from lcmtools.graph.protocol import NODE_CHANNEL
from lcmtools.names import is_hidden
from lcmtools.observe.log_file import LogFile

_MOST_EVENTS = 20_000  # that are looked at in a log without an index


def topics(situation: Situation) -> Iterator[Candidate]:
    """The topics of the logs that are named; by the beginning of one that has no index."""
    found: set[str] = set()
    for path in situation.all("files", "source"):
        with contextlib.suppress(LcmtoolsError):
            found.update(one.channel for one in recorded_graph(path).traffic)
    yield from (Candidate(name) for name in sorted(found) if not is_hidden(name))


def recorded_graph(path: str) -> Graph:
    """Return the nodes and channels of a log, by the beginning of one that has no index.

    Raises:
        BusError: It cannot be read, or is no log.
    """
    with LogFile(path) as log:
        builder = known_nodes(log)
        for event in islice(log.events(log.index.end), _MOST_EVENTS):
            is_node = event.channel == NODE_CHANNEL
            builder.add(event.packet(log.data) if is_node else event.head(log.data))
        counted = {name: one for block in log.index.blocks for name, one in block.channels.items()}
    graph = builder.snapshot(0)
    indexed = (
        Traffic(name, None, () if one.fingerprint is None else (one.fingerprint,), 1, 0, 0, 0)
        for name, one in counted.items()
    )
    return graph._replace(traffic=(*graph.traffic, *indexed))
