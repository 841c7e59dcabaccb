"""A log file with the index beside it: its messages, their senders, and the index's information."""

import mmap
import os
import stat
from bisect import bisect_right
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from shutil import copyfileobj
from tempfile import TemporaryFile
from typing import BinaryIO, cast

from lcmtools.errors import BusError, os_errors_as
from lcmtools.graph.protocol import NODE_CHANNEL
from lcmtools.observe.reading.losses import Loss
from lcmtools.observe.reading.unpacking import fitting
from lcmtools.observe.reports.describe import size_text
from lcmtools.wire.log_compression import Compression, compression_of, decompressed
from lcmtools.wire.log_events import SYNC, Event, events
from lcmtools.wire.log_index import SUFFIX, Block, LogIndex, parse_index
from lcmtools.wire.packet import Packet, Sender

_MOST_CHECKED = 100  # blocks of an index that are checked for belonging to the log
_FOREIGN = {
    b"\x89MCAP0\r\n": "an MCAP file",
    b"#ROSBAG V": "a ROS bag",
    b"SQLite format 3\0": "an SQLite database, like a ROS 2 bag",
    b"\x89PNG\r\n": "a PNG image",
    b"\xff\xd8\xff": "a JPEG image",
    b"%PDF": "a PDF document",
    b"\x7fELF": "a program",
    b"PK\x03\x04": "a ZIP archive",
    b"\x1f\x8b": "a file compressed by gzip",
    b'{"index":': "the index of a log, not the log",
}
STANDARD_INPUT = Path("-")
"""Stands for the log that is piped into a command."""
_BAGS = ("MCAP", "ROS")


class LogFile(AbstractContextManager["LogFile"]):
    """A log file that is open for reading; also a pipe, which is read to its end first.

    Raises:
        BusError: The file cannot be read, or is not a log.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)  # the file
        with os_errors_as(f"cannot read the log '{path}'", kind=BusError):
            self.data = _mapped(self.path)  # its bytes; of a compressed log, decompressed
        # The index beside it; an empty one if there is none that fits.
        self.index = _fitting(_read_index(self.path), self.data)
        if self.path.is_symlink() and not self.index.blocks:
            self.index = _fitting(_read_index(self.path.resolve()), self.data)
        # The senders by their numbers in the index, with their names.
        self.senders = {
            number: one.sender._replace(name=one.name)
            for number, one in self.index.senders.items()
            if one.sender
        }
        # the first message of a log may not be written completely yet
        begins = SYNC.startswith(self.data[: len(SYNC)])
        if not begins and not self.index.blocks and next(self.events(), None) is None:
            self.close()
            raise BusError(f"there are no messages in {path}", "it is not an LCM log")

    def __exit__(self, *_: object) -> None:
        """Close the file."""
        self.close()

    def close(self) -> None:
        """Close the file."""
        if isinstance(self.data, mmap.mmap):
            self.data.close()

    @property
    def size(self) -> int:
        """Bytes of the log."""
        return len(self.data)

    def events(self, start: int = 0, end: int | None = None) -> Iterator[Event]:
        """Yield the places of the events that begin in this range of bytes, in the file's order."""
        return events(self.data, start, end)

    def packets(self, start: int = 0) -> Iterator[Packet]:
        """Yield the messages from a byte on, with their senders if the index has them."""
        for event, sender in self.placed(start):
            yield event.packet(self.data)._replace(sender=sender)

    def placed(self, start: int = 0) -> Iterator[tuple[Event, Sender | None]]:
        """Yield the places of the events from a byte on, with their senders as in ``packets``."""
        for block in self.index.blocks:
            if block.end > start:
                yield from self.of_block(block, start)
        for event in self.events(max(start, self.index.end)):
            yield event, None

    def blocks(self, announced: Callable[[Packet], object] = lambda _: None) -> Iterator[Block]:
        """Yield the blocks of the index, and those found in the log after them.

        ``announced`` is called with the announcements of nodes in the latter.
        """
        yield from self.index.blocks
        block = Block(self.index.end)
        for event in self.events(self.index.end):
            if block.is_full(event.start):
                yield block
                block = Block(event.start)
            if not block.channels:
                block.start = event.start
            block.add(event.head(self.data))
            block.end = event.end
            if event.channel == NODE_CHANNEL:
                announced(event.packet(self.data))
        if block.channels:
            yield block

    def damage(self, blocks: Iterable[Block] | None = None) -> str:
        """Return a sentence on the bytes that belong to no message; "" if there are none.

        If ``blocks`` are given, as ``blocks`` yields them, the log is not read for this.
        """
        if blocks is None:
            known = sum(event.end - event.start for event in self.events())
        else:
            known = sum(block.event_bytes for block in blocks)
        return lost_bytes_text(self.path, max(0, self.size - known))

    def announcements(self) -> Iterator[Packet]:
        """Yield the announcements of nodes in the index."""
        for node in self.index.nodes:
            yield Packet(NODE_CHANNEL, node.payload, node.time, self.senders.get(node.sender))

    def losses(self, between: tuple[int, int] | None = None) -> dict[Sender, Loss]:
        """Return the loss of each sender, as the recorder saw it, all or between two times [ns]."""
        found: dict[Sender, Loss] = {}
        for lost in self.index.lost:
            if between and not between[0] <= lost.time <= between[1]:
                continue
            for number, counts in lost.counts.items():
                if sender := self.senders.get(number):
                    found[sender] = found.get(sender, Loss()) + Loss(*counts)
        return {sender: Loss(max(0, one.lost), one.sent) for sender, one in found.items()}

    def offset_at(self, time: int) -> int:
        """Return, by the index, an offset before which all events are before ``time`` [ns]."""
        latest, last_times = 0, []
        for block in self.index.blocks:
            latest = max(latest, block.last_time)
            last_times.append(latest)
        # the first block with an event of that time or later; times may go back from block to block
        place = bisect_right(last_times, time - 1)
        return self.index.blocks[place].start if place < len(last_times) else self.index.end

    def latest(self, channels: Iterable[str], time: int, blocks: Iterable[Block]) -> list[Packet]:
        """Return each sender's last message on each channel before a time [ns], in order of time.

        The log's ``blocks`` are given, as ``blocks`` yields them.
        """
        found: list[tuple[Event, Sender | None]] = []
        blocks = list(blocks)
        for channel in channels:
            some = [(one.channels[channel], one) for one in blocks if channel in one.channels]
            some = [(count, block) for count, block in some if count.first_time < time]
            senders = {self.senders.get(number) for count, _ in some for number, _ in count.senders}
            last: dict[Sender | None, Event] = {}
            for _, block in sorted(some, key=lambda one: one[0].last_time, reverse=True):
                for event, sender in self.of_block(block, block.start):
                    older = last.get(sender)
                    is_last = older is None or event.time >= older.time
                    if event.channel == channel and event.time < time and is_last:
                        last[sender] = event
                if senders <= last.keys():
                    break
            found += [(event, sender) for sender, event in last.items()]
        found.sort(key=lambda one: (one[0].time, one[0].start))
        return [event.packet(self.data)._replace(sender=sender) for event, sender in found]

    def loss_times(self) -> Iterator[tuple[int, Sender, Loss]]:
        """Yield when the recorder found messages of a sender lost [ns since 1970], and how many.

        They were lost since the record before, which is at most some seconds earlier.
        """
        for note in self.index.lost:
            for number, (lost, sent) in note.counts.items():
                if lost > 0 and (sender := self.senders.get(number)):
                    yield note.time, sender, Loss(lost, sent)

    def of_block(self, block: Block, start: int) -> Iterator[tuple[Event, Sender | None]]:
        """Yield the places of a block's events from a byte on, with their senders if known."""
        found: Iterable[Event] = self.events(block.start, block.end)
        channels = block.channels
        if any(len(count.senders) > 1 for count in channels.values()):
            # if events were damaged later, their order no longer tells the others' senders
            found = list(found)
            counts = Counter(event.channel for event in found)
            channels = {
                name: count
                for name, count in channels.items()
                if len(count.senders) == 1 or count.messages == counts[name]
            }
        senders = {name: self._in_order(count.senders) for name, count in channels.items()}
        for event in found:
            sender = next(senders.get(event.channel, iter(())), None)
            if event.start >= start:
                yield event, sender

    def _in_order(self, runs: list[list[int]]) -> Iterator[Sender | None]:
        for number, messages in runs:
            sender = self.senders.get(number)
            for _ in range(messages):
                yield sender


def _mapped(path: Path) -> "bytes | mmap.mmap":
    with _opened(path) as file:
        if os.fstat(file.fileno()).st_size == 0:  # an empty file cannot be mapped
            return b""
        head = file.read(max(map(len, _FOREIGN)))
        if kind := compression_of(head):
            return _decompressed(file, kind, path)
        if not head.startswith(SYNC):
            _refuse_foreign(path, head)
        return mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)


def _opened(path: Path) -> BinaryIO:
    """Open a file; the content of a pipe, up to its end, becomes an unnamed temporary file."""
    is_input = path == STANDARD_INPUT
    mode = os.fstat(0).st_mode if is_input else path.stat().st_mode
    if is_input or stat.S_ISFIFO(mode):
        if os.isatty(0) and is_input:
            raise BusError("standard input is a terminal", "pipe a log into it, or name a file")
        content = TemporaryFile()  # noqa: SIM115 - its user closes it
        with os.fdopen(0, "rb", closefd=False) if is_input else path.open("rb") as pipe:
            copyfileobj(pipe, content)
        content.seek(0)
        return cast(BinaryIO, content)
    if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode)):
        raise BusError(f"{path} is not a file", "a log is read from a file or a pipe")
    return path.open("rb")


def _refuse_foreign(path: Path, head: bytes) -> None:
    for magic, name in _FOREIGN.items():
        if head.startswith(magic):
            is_bag = any(word in name for word in _BAGS)
            hint = f"lcmtools bag import {path} makes a log of it" if is_bag else ""
            hint = f"zcat {path} | lcmtools bag info -" if "gzip" in name else hint
            raise BusError(f"{path} is not an LCM log but {name}", hint)


def _decompressed(file: BinaryIO, kind: Compression, path: Path) -> "bytes | mmap.mmap":
    """Return the bytes of a compressed log, in an unnamed temporary file."""
    file.seek(0)
    with TemporaryFile() as plain:
        for part in fitting(decompressed(kind, file), path):
            plain.write(part)
        plain.flush()
        if plain.tell() == 0:
            return b""
        return mmap.mmap(plain.fileno(), 0, access=mmap.ACCESS_READ)


def index_path(log: Path) -> Path:
    """Return the path of a log's index."""
    return log.with_name(log.name + SUFFIX)


def _read_index(log: Path) -> LogIndex | None:
    path = index_path(log)
    try:
        if not path.is_file():  # a pipe may never end
            return None
        with path.open(encoding="utf-8", errors="replace") as lines:
            return parse_index(lines)
    except OSError:
        return None


def _fitting(index: LogIndex | None, data: "bytes | mmap.mmap") -> LogIndex:
    """Return the index if it belongs to these bytes, else an empty one.

    Blocks must begin with an event. The index of another file, or of this one before it was
    rewritten, is useless.
    """
    if index is None or index.end > len(data) or index.size not in (None, len(data)):
        return LogIndex()
    checked = index.blocks[:: len(index.blocks) // _MOST_CHECKED + 1]
    is_of_these = all(data[block.start : block.start + len(SYNC)] == SYNC for block in checked)
    return index if is_of_these else LogIndex()


def lost_bytes_text(path: str | Path, lost: int) -> str:
    """Return a sentence on the bytes of a log that belong to no message; "" if there are none."""
    what = f"{size_text(lost)} of {path} do not belong to any message"
    return f"{what}; lcmtools bag fix shows where" if lost else ""
