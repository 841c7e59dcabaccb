"""Writing a log and the index beside it.

Whole events reach the file: what a full disk or a write that failed leaves of an event is cut off.
"""

import os
from collections.abc import Iterable, Mapping
from contextlib import AbstractContextManager
from pathlib import Path

from lcmtools.errors import LcmtoolsError
from lcmtools.observe.log_file import index_path
from lcmtools.wire import log_index
from lcmtools.wire.log import encode_event
from lcmtools.wire.log_index import Block, RecordedNode, RecordedSender, RecordedType
from lcmtools.wire.packet import Packet, Sender

_MOST_AT_ONCE = os.sysconf("SC_IOV_MAX")  # parts that a system call writes


class LogWriter(AbstractContextManager["LogWriter"]):
    """A log that is being written, and its index.

    ``add`` only takes messages; ``flush`` writes them.

    Args:
        path: The log.
        force: Take the place of a file that exists.

    Attributes:
        path: The log.
        messages: The number of messages that were added.
        size: Bytes of the log, with what is not yet written.

    Raises:
        LcmtoolsError: The file exists, or cannot be written.
    """

    def __init__(self, path: str | Path, *, force: bool = False) -> None:
        self.path = Path(path)
        self.messages = self.size = 0
        self._log = _create(self.path, force=force)
        try:
            self._index = _create(index_path(self.path), force=True)
        except LcmtoolsError:
            os.close(self._log)
            self.path.unlink(missing_ok=True)
            raise
        self._waiting: list[bytes] = []
        self._written = 0
        self._lines = [log_index.index_line()]
        self._block = Block(0)
        self._senders: dict[tuple[Sender | None, str], int] = {}
        self._types: set[str] = set()

    def __exit__(self, *_: object) -> None:
        """Write what is left, and close the files."""
        self.close()

    def add(self, packet: Packet, sender: int = -1) -> None:
        """Take a message; ``sender`` is a number that ``sender_number`` gave."""
        event = encode_event(self.messages, packet)
        self._waiting.append(event)
        self.messages += 1
        self.size += len(event)
        self._block.add(packet, sender)

    def sender_number(self, sender: Sender | None, name: str) -> int:
        """Return the number of a sender in this log."""
        key = sender, name
        if key not in self._senders:
            number = self._senders[key] = len(self._senders)
            self._lines.append(log_index.sender_line(number, RecordedSender(sender, name)))
        return self._senders[key]

    def add_types(self, types: Iterable[RecordedType]) -> None:
        """Keep message types in the index, each once."""
        for one in types:
            if one.name not in self._types:
                self._types.add(one.name)
                self._lines.append(log_index.type_line(one))

    def add_node(self, node: RecordedNode) -> None:
        """Keep an announcement of a node in the index."""
        self._lines.append(log_index.node_line(node))

    def set_losses(self, losses: Mapping[int, tuple[int, int]]) -> None:
        """Keep the messages lost until now, and those sent, by the sender's number."""
        self._lines.append(log_index.losses_line(losses))

    def flush(self) -> None:
        """Write what was added; the log first, so that the index never says more than it has.

        Raises:
            LcmtoolsError: The disk is full, for example; the log ends with its last whole event.
        """
        self._write_events()
        if self._block.is_full(self.size):
            self._end_block()
        self._write_lines()

    def close(self) -> None:
        """Write what is left, and close the files; does nothing the second time.

        Raises:
            LcmtoolsError: As of ``flush``.
        """
        if self._log < 0:
            return
        try:
            self._write_events()
            if self._block.channels:
                self._end_block()
            self._lines.append(log_index.end_line(self.size))
            self._write_lines()
        finally:
            os.close(self._log)
            os.close(self._index)
            self._log = -1

    def _end_block(self) -> None:
        self._block.end = self.size
        self._lines.append(log_index.block_line(self._block))
        self._block = Block(self.size)

    def _write_events(self) -> None:
        waiting, self._waiting = self._waiting, []
        try:
            for start in range(0, len(waiting), _MOST_AT_ONCE):
                self._write_some(waiting[start : start + _MOST_AT_ONCE])
        except OSError as error:
            os.ftruncate(self._log, self._written)
            self.size = self._written
            raise _failure(self.path, error) from error

    def _write_some(self, some: list[bytes]) -> None:
        """Write some events; those that are written whole count even if the others fail."""
        left = list(some)
        while left:
            written = os.writev(self._log, left)
            while left and written >= len(left[0]):
                written -= len(left[0])
                self._written += len(left.pop(0))
            if written:
                part = left[0]
                while written < len(part):
                    written += os.write(self._log, part[written:])
                self._written += len(part)
                left.pop(0)

    def _write_lines(self) -> None:
        lines, self._lines = self._lines, []
        data = "".join(lines).encode()
        try:
            while data:
                data = data[os.write(self._index, data) :]
        except OSError as error:
            raise _failure(index_path(self.path), error) from error


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
