"""Making a log from others: messages with their senders in, a log with its index out.

Facts in the others' indexes (types, nodes, senders) are carried over, and so are the losses of
senders with messages in the result. The result appears when it is complete.
"""

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from lcmtools.bag.output import output_beside
from lcmtools.bag.summary import Progress
from lcmtools.bag.writer import LogWriter
from lcmtools.observe.reading.log_file import LogFile
from lcmtools.wire.log_compression import named_compression
from lcmtools.wire.log_index import LostMessages, RecordedNode, RecordedType
from lcmtools.wire.packet import Packet, Sender

_AT_ONCE = 4 << 20  # bytes that wait to be written


def write_log(  # noqa: PLR0913 - each is a separate option
    target: str | Path,
    packets: Iterable[Packet],
    sources: Sequence[LogFile],
    *,
    force: bool = False,
    change_node: Callable[[RecordedNode], RecordedNode] = lambda node: node,
    between: tuple[int, int] | None = None,
    later: int = 0,
    types: Iterable[RecordedType] = (),
    nodes: Iterable[RecordedNode] = (),
    progress: Progress = lambda _: None,
) -> LogWriter:
    """Write messages into a log; return what wrote it, which knows how much that was.

    Args:
        target: The log.
        packets: Its messages, in order.
        sources: The logs from which they come.
        force: Replace an existing file, which may be one of the sources.
        change_node: Changes nodes' announcements in the same way as messages were changed.
        between: The time range of the messages in the sources [ns since 1970]; None for all.
        later: The time by which messages are later than in the sources [ns].
        types: Types that the sources do not have; read after all messages have been written.
        nodes: Announcements that the sources do not have; read then, too.
        progress: Called with the number of written bytes.

    Raises:
        LcmtoolsError: The file exists, or cannot be written.
    """
    target = Path(target)
    with (
        output_beside(target, force=force) as made,
        LogWriter(made, compression=named_compression(target)) as writer,
    ):
        copier = _Copier(writer)
        for source in sources:
            writer.add_types(source.index.types.values())
        copier.copy(packets, progress)
        for source in sources:
            copier.carry_lost(source, between, later)
            copier.carry_nodes(source, change_node, later)
        writer.add_types(types)
        for node in nodes:
            writer.add_node(node)
    return writer


class _Copier:
    """Copies messages, and the facts about their logs, into another log."""

    def __init__(self, writer: LogWriter) -> None:
        self._writer = writer
        self._numbers: dict[Sender | None, int] = {None: -1}

    def carry_lost(self, source: LogFile, between: tuple[int, int] | None, later: int) -> None:
        """Carry over the losses of the messages' senders within these times."""
        kept = {n: self._numbers[one] for n, one in source.senders.items() if one in self._numbers}
        for time, counts in source.index.lost:
            if between is None or between[0] <= time <= between[1]:
                known = {kept[n]: count for n, count in counts.items() if n in kept}
                self._writer.add_lost(LostMessages(time + later, known))

    def carry_nodes(
        self, source: LogFile, change: Callable[[RecordedNode], RecordedNode], later: int
    ) -> None:
        for node in map(change, source.index.nodes):
            sender = self._number(source.senders.get(node.sender))
            self._writer.add_node(RecordedNode(node.time + later, sender, node.payload))

    def copy(self, packets: Iterable[Packet], progress: Progress) -> None:
        written = 0
        for packet in packets:
            self._writer.add(packet, self._number(packet.sender))
            if self._writer.size - written >= _AT_ONCE:
                self._writer.flush()
                written = self._writer.size
                progress(written)

    def _number(self, sender: Sender | None) -> int:
        if sender not in self._numbers:
            unnamed = sender._replace(name="") if sender else None
            self._numbers[sender] = self._writer.sender_number(unnamed, str(sender))
        return self._numbers[sender]
