"""Writing the index of a log that has none, or none of its end."""

from collections.abc import Iterator

from lcmtools.bag.output import output_beside
from lcmtools.bag.summary import Progress
from lcmtools.graph.protocol import head_of
from lcmtools.observe.log_file import LogFile, index_path
from lcmtools.wire import log_index
from lcmtools.wire.log_index import RecordedNode
from lcmtools.wire.packet import Packet


def reindex_log(log: LogFile, progress: Progress = lambda _: None) -> int:
    """Write a log's index, with all that it had; return the number of bytes that it is of.

    Raises:
        LcmtoolsError: It cannot be written.
    """
    with (
        output_beside(index_path(log.path), force=True) as made,
        made.open("w", encoding="utf-8") as file,
    ):
        file.writelines(_lines(log, progress))
    return log.size


def _lines(log: LogFile, progress: Progress) -> Iterator[str]:
    index, nodes = log.index, _NewNodes()
    yield log_index.index_line()
    for number, sender in index.senders.items():
        yield log_index.sender_line(number, sender)
    yield from map(log_index.type_line, index.types.values())
    yield from map(log_index.node_line, index.nodes)
    for block in log.blocks(nodes.take):
        progress(block.end)
        yield from map(log_index.node_line, nodes.found)
        nodes.found.clear()
        yield log_index.block_line(block)
    if index.losses:
        yield log_index.losses_line(index.losses)
    yield log_index.end_line(log.size)


class _NewNodes:
    """Announcements that say more than the ones before."""

    def __init__(self) -> None:
        self.found: list[RecordedNode] = []
        self._revisions: dict[bytes, bytes] = {}

    def take(self, packet: Packet) -> None:
        identity, revision = head_of(packet.payload)
        if self._revisions.get(identity) != revision:
            self._revisions[identity] = revision
            self.found.append(RecordedNode(packet.time, -1, packet.payload))
