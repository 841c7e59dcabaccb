"""A log file with the index beside it: its messages, their senders, its times."""

import mmap
from bisect import bisect_right
from collections.abc import Iterator
from contextlib import AbstractContextManager
from pathlib import Path

from lcmtools.errors import BusError
from lcmtools.wire.log import SYNC, Event, events
from lcmtools.wire.log_index import SUFFIX, Block, LogIndex, parse_index
from lcmtools.wire.packet import Packet, Sender


class LogFile(AbstractContextManager["LogFile"]):
    """A log file that is open for reading.

    Attributes:
        path: The file.
        data: Its bytes.
        index: What the index beside it says; an empty one where there is none that fits.

    Raises:
        BusError: The file cannot be read.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        try:
            self.data = _mapped(self.path)
        except OSError as error:
            raise BusError(f"cannot read the log '{path}': {error.strerror}") from error
        self.index = _fitting(_read_index(self.path), self.data)

    def __exit__(self, *_: object) -> None:
        """Close the file."""
        self.close()

    def close(self) -> None:
        """Close the file."""
        if isinstance(self.data, mmap.mmap):
            self.data.close()

    def events(self, start: int = 0, end: int | None = None) -> Iterator[Event]:
        """Yield the places of the events that begin within some bytes, as they lie there."""
        return events(self.data, start, end)

    def packets(self, start: int = 0) -> Iterator[Packet]:
        """Yield the messages from some byte on, with their senders where the index has them."""
        for block in self.index.blocks:
            if block.end > start:
                yield from self._of_block(block, start)
        for event in self.events(max(start, self.index.end)):
            yield event.packet(self.data)

    def offset_at(self, time: int) -> int:
        """Return a byte before which no event is of ``time`` [ns] or later, by the index."""
        latest, last_times = 0, []
        for block in self.index.blocks:
            latest = max(latest, block.last_time)
            last_times.append(latest)
        # the first block with an event of that time or later; times may go back from block to block
        place = bisect_right(last_times, time - 1)
        return self.index.blocks[place].start if place < len(last_times) else self.index.end

    def _of_block(self, block: Block, start: int) -> Iterator[Packet]:
        counts = block.channels.items()
        senders = {name: _in_order(self.index, count.senders) for name, count in counts}
        for event in self.events(block.start, block.end):
            sender = next(senders.get(event.channel, iter(())), None)
            if event.start >= start:
                yield event.packet(self.data)._replace(sender=sender)


def _in_order(index: LogIndex, runs: list[list[int]]) -> Iterator[Sender | None]:
    for number, messages in runs:
        known = index.senders.get(number)
        for _ in range(messages):
            yield known.sender if known else None


def _mapped(path: Path) -> "bytes | mmap.mmap":
    if path.stat().st_size == 0:  # it cannot be mapped
        return b""
    with path.open("rb") as file:
        return mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)


def index_path(log: Path) -> Path:
    """Return the path of a log's index."""
    return log.with_name(log.name + SUFFIX)


def _read_index(log: Path) -> LogIndex | None:
    try:
        with index_path(log).open(encoding="utf-8", errors="replace") as lines:
            return parse_index(lines)
    except OSError:
        return None


def _fitting(index: LogIndex | None, data: "bytes | mmap.mmap") -> LogIndex:
    """Return the index if it is of these bytes, else an empty one.

    Each block must begin with an event: an index of another file, or of this one before it was
    written again, says nothing.
    """
    if index is None or index.end > len(data) or index.size not in (None, len(data)):
        return LogIndex()
    is_of_these = all(data[block.start : block.start + len(SYNC)] == SYNC for block in index.blocks)
    return index if is_of_these else LogIndex()
