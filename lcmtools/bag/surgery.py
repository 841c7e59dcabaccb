"""Making a log of others: messages with their senders in, a log with its index out.

What the indexes of the others know (types, nodes, senders, losses) is carried over. The result
appears when it is whole.
"""

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from lcmtools.bag.output import output_beside
from lcmtools.bag.summary import Progress
from lcmtools.bag.writer import LogWriter
from lcmtools.observe.log_file import LogFile, index_path
from lcmtools.observe.losses import Loss
from lcmtools.wire.log_index import RecordedNode, RecordedType
from lcmtools.wire.packet import Packet, Sender

_AT_ONCE = 4 << 20  # bytes that wait to be written


def write_log(  # noqa: PLR0913 - each is an option of its own
    target: str | Path,
    packets: Iterable[Packet],
    sources: Sequence[LogFile],
    *,
    force: bool = False,
    change_node: Callable[[RecordedNode], RecordedNode] = lambda node: node,
    types: Iterable[RecordedType] = (),
    progress: Progress = lambda _: None,
) -> int:
    """Write messages into a log, and return their number.

    Args:
        target: The log.
        packets: Its messages, in their order.
        sources: The logs that they are from.
        force: Take the place of a file that exists; it may be one of the sources.
        change_node: Changes the announcements of nodes, as the messages have been changed.
        types: Types that the sources do not have; asked for when all messages are written.
        progress: Called with the number of bytes that have been written.

    Raises:
        LcmtoolsError: The file exists, or cannot be written.
    """
    target = Path(target)
    with output_beside(target, force=force) as made:
        with LogWriter(made) as writer:
            copier = _Copier(writer)
            for source in sources:
                copier.carry(source, change_node)
            copier.copy(packets, progress)
            writer.add_types(types)
        # with the old log the new index says nothing
        index_path(made).rename(index_path(target))
    return writer.messages


class _Copier:
    """Copies messages, and what is known of their logs, into another log."""

    def __init__(self, writer: LogWriter) -> None:
        self._writer = writer
        self._losses: dict[int, Loss] = {}
        self._numbers: dict[Sender | None, int] = {None: -1}

    def carry(self, source: LogFile, change_node: Callable[[RecordedNode], RecordedNode]) -> None:
        """Carry over what the index of a log knows beside its messages."""
        self._writer.add_types(source.index.types.values())
        for node in source.index.nodes:
            moved = change_node(node)
            sender = self._number(source.senders.get(node.sender))
            self._writer.add_node(RecordedNode(moved.time, sender, moved.payload))
        for lossy, loss in source.losses().items():
            number = self._number(lossy)
            self._losses[number] = self._losses.get(number, Loss()) + loss
        if self._losses:
            self._writer.set_losses({n: (one.lost, one.sent) for n, one in self._losses.items()})

    def copy(self, packets: Iterable[Packet], progress: Progress) -> None:
        """Copy messages."""
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
