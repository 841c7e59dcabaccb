"""Writing the index of a log that has none, or an incomplete one."""

from collections.abc import Iterator

from lcmtools.bag.index_notes import recorded_types
from lcmtools.bag.output import output_beside
from lcmtools.bag.summary import Progress, known_nodes
from lcmtools.errors import LcmtoolsError
from lcmtools.graph.protocol import head_of
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.observe.reading.log_file import LogFile, index_path
from lcmtools.wire import log_index
from lcmtools.wire.log_index import RecordedNode
from lcmtools.wire.packet import Packet


def reindex_log(log: LogFile, progress: Progress = lambda _: None) -> int:
    """Write a log's index, keeping the existing one's facts; return the number of covered bytes.

    Missing definitions of types are added if known here.

    Raises:
        LcmtoolsError: The log is not a file, or its index cannot be written.
    """
    if not log.path.is_file():
        raise LcmtoolsError(f"{log.path} is not a file", "an index is written beside a file")
    with (
        output_beside(index_path(log.path), force=True) as made,
        made.open("w", encoding="utf-8") as file,
    ):
        file.writelines(_lines(log, progress))
    return log.size


def _lines(log: LogFile, progress: Progress) -> Iterator[str]:
    index, nodes = log.index, _NewNodes()
    builder, seen = known_nodes(log), dict[tuple[str, int], None]()

    def add(packet: Packet) -> None:
        nodes.add(packet)
        builder.add(packet)

    yield log_index.index_line()
    for number, sender in index.senders.items():
        yield log_index.sender_line(number, sender)
    yield from map(log_index.type_line, index.types.values())
    yield from map(log_index.node_line, index.nodes)
    for block in log.blocks(add):
        progress(block.end)
        yield from map(log_index.node_line, nodes.found)
        nodes.found.clear()
        yield log_index.block_line(block)
        counts = block.channels.items()
        seen |= {(name, one.fingerprint): None for name, one in counts if one.fingerprint}
    yield from map(log_index.lost_line, index.lost)
    heads = (Packet(name, number.to_bytes(8, "big"), 0) for name, number in seen)
    known = {(one.name, one.fingerprint) for one in index.types.values()}
    for kind in recorded_types(heads, Decoder(builder.types_of)):
        if (kind.name, kind.fingerprint) not in known:
            yield log_index.type_line(kind)
    yield log_index.end_line(log.size)


class _NewNodes:
    """Announcements that differ from the ones before."""

    def __init__(self) -> None:
        self.found: list[RecordedNode] = []
        self._revisions: dict[bytes, bytes] = {}

    def add(self, packet: Packet) -> None:
        identity, revision = head_of(packet.payload)
        if self._revisions.get(identity) != revision:
            self._revisions[identity] = revision
            self.found.append(RecordedNode(packet.time, -1, packet.payload))
