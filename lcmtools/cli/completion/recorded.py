"""The graph of a log, read quickly."""

from itertools import islice

from lcmtools.bag.summary import known_nodes
from lcmtools.graph.model import Graph, Traffic
from lcmtools.graph.protocol import NODE_CHANNEL
from lcmtools.observe.reading.log_file import LogFile

_MOST_EVENTS = 20_000  # read from a log without an index


def recorded_graph(path: str) -> Graph:
    """Return the nodes and channels of a log; without an index, those of its beginning.

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
