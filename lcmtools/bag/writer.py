"""Writing a log and the index beside it.

The file gets whole events: if a write fails, as on a full disk, a partial event is cut off.
"""

import os
from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager
from itertools import takewhile
from pathlib import Path
from typing import NamedTuple, NoReturn

from lcmtools.bounded import BoundedDict
from lcmtools.errors import LcmtoolsError
from lcmtools.folders import open_stream
from lcmtools.graph.builder import MOST_FLOWS
from lcmtools.observe.reading.log_file import index_path
from lcmtools.wire import log_index
from lcmtools.wire.log_compression import Compression, compressor
from lcmtools.wire.log_events import encode_head, events
from lcmtools.wire.log_index import Block, LostMessages, RecordedNode, RecordedSender, RecordedType
from lcmtools.wire.packet import Packet, Sender

_AT_ONCE = 512 << 10  # bytes per system call; with more, Linux takes several times longer per byte


class WriteBatch(NamedTuple):
    """Events and lines to be written; one thread can take a batch while another one writes."""

    start: int  # offset of the first event in the log [byte]
    parts: list[bytes]  # the bytes of the events, in pieces
    lines: list[str]  # lines of the index


class LogWriter(AbstractContextManager["LogWriter"]):
    """A log that is being written, and its index.

    ``add`` only queues messages. ``flush`` writes them; or, on another thread, ``write`` writes a
    batch of them that ``take`` returned: a compressed frame, if there is a ``compression``. With
    ``force`` it replaces an existing file. A stream, as ``folders.open_stream`` has it, gets the
    log without an index.

    Raises:
        LcmtoolsError: The file exists, or cannot be written.
    """

    def __init__(
        self, path: str | Path, *, force: bool = False, compression: Compression | None = None
    ) -> None:
        self.path = Path(path)
        self._compress = compressor(compression) if compression else None
        self.messages = 0  # number of added messages
        self.size = 0  # uncompressed bytes of the log, including those not yet written
        stream = open_stream(self.path)
        self._is_stream = stream is not None
        self._log = _create(self.path, force=force) if stream is None else stream
        index = Path(os.devnull) if self._is_stream else index_path(self.path.resolve())
        try:
            self._index = _create(index, force=True)
        except LcmtoolsError:
            os.close(self._log)
            if not self._is_stream:
                self.path.resolve().unlink(missing_ok=True)
            raise
        self._parts: list[bytes] = []
        self._lines = [log_index.index_line()]
        self._block = Block(0)
        self._taken = 0
        self._is_cut_off = False  # True after a failed write: the index ends before it
        self._senders = BoundedDict[tuple[Sender | None, str], int](MOST_FLOWS)
        self._next_sender = 0
        self._types: set[tuple[str, int]] = set()  # names and fingerprints

    def __exit__(self, *_: object) -> None:
        """Write the rest, and close the files."""
        self.close()

    def add(self, packet: Packet, sender: int = -1) -> None:
        """Add a message; ``sender`` is a number from ``sender_number``."""
        head, payload = encode_head(self.messages, packet), packet.payload
        self._parts += (head, payload)
        self.messages += 1
        self.size += len(head) + len(payload)
        self._block.add(packet, sender)

    def sender_number(self, sender: Sender | None, name: str) -> int:
        """Return the number of a sender in this log."""
        number = self._senders.use((sender, name))
        if number is None:
            number = self._senders[sender, name] = self._next_sender
            self._next_sender += 1
            self._lines.append(log_index.sender_line(number, RecordedSender(sender, name)))
        return number

    def rename_sender(self, number: int, sender: Sender | None, name: str) -> None:
        """Give a sender of this log, by its number, a new name."""
        self._lines.append(log_index.sender_line(number, RecordedSender(sender, name)))

    def add_types(self, types: Iterable[RecordedType]) -> None:
        """Keep message types in the index, each once."""
        for one in types:
            if (key := (one.name, one.fingerprint)) not in self._types:
                self._types.add(key)
                self._lines.append(log_index.type_line(one))

    def add_node(self, node: RecordedNode) -> None:
        """Keep an announcement of a node in the index."""
        self._lines.append(log_index.node_line(node))

    def add_lost(self, lost: LostMessages) -> None:
        """Keep the messages lost since the last such record."""
        self._lines.append(log_index.lost_line(lost))

    @property
    def waiting_bytes(self) -> int:
        """Bytes of the events that were added since the last batch was taken."""
        return self.size - self._taken

    def pop_batch(self) -> WriteBatch:
        """Return the events added since the last batch, for ``write``, in the same order."""
        if self._block.is_full(self.size):
            self._end_block()
        batch = WriteBatch(self._taken, self._parts, self._lines)
        self._parts, self._lines = [], []
        self._taken = self.size
        return batch

    def write(self, batch: WriteBatch) -> None:
        """Write a batch, the log first, so that the index never covers more than the log.

        Raises:
            LcmtoolsError: A write failed, as on a full disk; the log ends with a whole event.
        """
        self._write_events(batch)
        self._write_lines(batch.lines)

    def flush(self) -> None:
        """Write what was added; raises errors as ``write`` does."""
        self.write(self.pop_batch())

    def close(self) -> None:
        """Write the rest, and close the files; a second call does nothing.

        Raises:
            LcmtoolsError: As in ``write``.
        """
        if self._log < 0:
            return
        try:
            if self._is_cut_off:
                self.pop_batch()
            elif self._block.channels:
                self._end_block()
            self._lines.append(log_index.end_line(self.size))
            self.flush()
        finally:
            os.close(self._log)
            os.close(self._index)
            self._log = -1

    def _end_block(self) -> None:
        self._block.end = self.size
        self._lines.append(log_index.block_line(self._block))
        self._block = Block(self.size)

    def _write_events(self, batch: WriteBatch) -> None:
        if self._compress:
            data = b"".join(batch.parts)
            self._write_frame(batch.start, self._compress(data) if data else b"")
            return
        written = 0
        try:
            for piece in _pieces(batch.parts):
                left = memoryview(piece)
                while left:
                    done = os.write(self._log, left[:_AT_ONCE])
                    written, left = written + done, left[done:]
        except OSError as error:
            ends = (event.end for event in events(b"".join(batch.parts)))
            whole = max(takewhile(lambda end: end <= written, ends), default=0)
            self.size = self._taken = batch.start + whole
            self._cut_off(self.size, error)

    def _write_frame(self, begin: int, frame: bytes) -> None:
        start = 0 if self._is_stream else os.lseek(self._log, 0, os.SEEK_CUR)
        try:
            while frame:
                frame = frame[os.write(self._log, frame) :]
        except OSError as error:
            self.size = self._taken = begin
            self._cut_off(start, error)

    def _cut_off(self, end: int, error: OSError) -> NoReturn:
        """End the log after its last whole event or frame; an error is raised."""
        self._is_cut_off = True
        if self._is_stream:
            raise error if isinstance(error, BrokenPipeError) else _failure(self.path, error)
        os.ftruncate(self._log, end)
        raise _failure(self.path, error) from error

    def _write_lines(self, lines: list[str]) -> None:
        data = "".join(lines).encode()
        try:
            while data:
                data = data[os.write(self._index, data) :]
        except OSError as error:
            raise _failure(index_path(self.path), error) from error


def _pieces(parts: list[bytes]) -> Iterator[bytes]:
    """Yield the parts joined, some at a time: joining all would delay the reading thread."""
    some, size = [], 0
    for part in parts:
        some.append(part)
        size += len(part)
        if size >= _AT_ONCE:
            yield b"".join(some)
            some, size = [], 0
    yield b"".join(some)


def _create(path: Path, *, force: bool) -> int:
    flags = os.O_WRONLY | os.O_CREAT | os.O_CLOEXEC | (os.O_TRUNC if force else os.O_EXCL)
    try:
        return os.open(path, flags, 0o666)
    except FileExistsError:
        raise LcmtoolsError(f"{path} exists", "name another file, or add --force") from None
    except OSError as error:
        raise _failure(path, error) from error


def _failure(path: Path, error: OSError) -> LcmtoolsError:
    return LcmtoolsError(f"cannot write {path}: {error.strerror}")
