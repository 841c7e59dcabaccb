"""Messages to publish and requests to send: from values, a file, or a stream as it comes.

Belongs here: reading them, and errors that name the source. Must not know YAML nor what becomes of
the messages.
"""

import itertools
import math
import os
import select
import stat
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from lcmtools.errors import InvalidFile, UsageError, ValueMismatch
from lcmtools.messages.documents import LONGEST
from lcmtools.messages.fields import visible_fields
from lcmtools.messages.message_template import MessageTemplate
from lcmtools.messages.registry import Message
from lcmtools.messages.yaml_input import draft_from_values, drafts_from_lines

Template: TypeAlias = MessageTemplate[Message]
Notify: TypeAlias = Callable[[str], None]

_STDIN = 0
_BLOCK_BYTES = 1 << 16
_POLL = 0.02  # [s] between two turns of the caller while nothing comes
_PATIENCE = 2.0  # [s] before the person reads that nothing comes


@dataclass(frozen=True, slots=True)
class Incoming:
    """Messages to be sent.

    Attributes:
        templates: The messages; None where the next one has not come yet.
        is_file: They are in a file, all of them read and checked.
        is_one: There is one message, and it may be sent again and again.
    """

    templates: Iterator[Template | None]
    is_file: bool = False
    is_one: bool = False

    @property
    def is_stream(self) -> bool:
        """True if they come one by one and their number is unknown."""
        return not (self.is_file or self.is_one)


def read_incoming(
    kind: type[Message],
    values: Sequence[str],
    file: str | None,
    notify: Notify,
    *,
    noun: str = "message",
) -> Incoming:
    """Return the messages of a command line; all of them are checked, unless it is a stream.

    Without values, the content of a pipe or a file on standard input is meant, as with rostopic.

    Raises:
        UsageError: Values and a file are both given, or the file has no message.
        InvalidFile: The file cannot be read.
        ValueMismatch: A value does not fit its field.
    """
    if file is not None and values:
        raise UsageError("values and -f exclude each other", "use one of them")
    if file == "-" or tuple(values) == ("-",):
        return _Reader(kind, _STDIN, "standard input", noun, notify).incoming()
    if file is not None:
        return _Reader(kind, _opened(file), file, noun, notify).incoming()
    if not values and visible_fields(kind) and _is_piped():
        templates = _Reader(kind, _STDIN, "standard input", noun, notify).templates()
        for first in templates:
            if first is not None:
                return Incoming(itertools.chain([first], templates))
    return Incoming(iter([draft_from_values(kind, values)]), is_one=True)


def read_requests(
    kind: type[Message], values: Sequence[str], file: str | None, notify: Notify
) -> list[Template]:
    """Return the requests of a command line, all read and checked; see ``read_incoming``."""
    incoming = read_incoming(kind, values, file, notify, noun="request")
    return [template for template in incoming.templates if template is not None]


@dataclass(frozen=True, slots=True)
class _Reader:
    """Reads messages from a file descriptor."""

    kind: type[Message]
    descriptor: int
    source: str
    noun: str
    notify: Notify

    def incoming(self) -> Incoming:
        mode = _mode(self.descriptor)
        if not mode:  # the bus would take its number
            raise InvalidFile(f"cannot read {self.source}: it is closed")
        if not stat.S_ISREG(mode):
            return Incoming(self._stream())
        found = [template for template in self.templates() if template is not None]
        if not found:
            raise self._empty()
        is_one = len(found) == 1 and self.descriptor != _STDIN
        return Incoming(iter(found), is_file=True, is_one=is_one)

    def templates(self) -> Iterator[Template | None]:
        """The messages; the person reads it when the first takes long."""
        deadline = time.monotonic() + _PATIENCE
        try:
            for template in drafts_from_lines(self.kind, self._lines()):
                if template is not None:
                    deadline = math.inf
                elif time.monotonic() >= deadline:
                    self.notify(f"waiting for {self.noun}s on {self.source}")
                    deadline = math.inf
                yield template
        except ValueMismatch as mismatch:
            raise ValueMismatch(f"{self.source}: {mismatch.what}", mismatch.hint) from None
        finally:
            if self.descriptor != _STDIN:
                os.close(self.descriptor)

    def _stream(self) -> Iterator[Template | None]:
        is_empty = True
        for template in self.templates():
            is_empty = is_empty and template is None
            yield template
        if is_empty:
            raise self._empty()

    def _lines(self) -> Iterator[str | None]:
        """The lines as they come; None where there is none for a moment."""
        rest = bytearray()
        while True:
            try:
                if not select.select([self.descriptor], [], [], _POLL)[0]:
                    yield None
                    continue
                block = os.read(self.descriptor, _BLOCK_BYTES)
            except OSError as error:
                raise _unreadable(self.source, error) from error
            *lines, last = block.split(b"\n")
            for line in lines:
                yield self._text(bytes(rest) + line)
                rest.clear()
            rest += last
            if not block:
                yield self._text(bytes(rest))
                return
            if len(rest) > LONGEST:
                raise InvalidFile(f"{self.source}: a line does not end")

    def _text(self, line: bytes) -> str:
        try:
            return line.decode()
        except UnicodeDecodeError as error:
            raise _unreadable(self.source, error) from None

    def _empty(self) -> UsageError:
        return UsageError(
            f"{self.source} has no {self.noun} in it", "write YAML documents, separated by ---"
        )


def _opened(file: str) -> int:
    try:
        descriptor = os.open(file, os.O_RDONLY)
        if stat.S_ISDIR(os.fstat(descriptor).st_mode):
            os.close(descriptor)
            raise IsADirectoryError(21, "Is a directory")
    except (OSError, ValueError) as error:
        raise _unreadable(file, error) from error
    return descriptor


def _unreadable(source: str, error: Exception) -> InvalidFile:
    reason = getattr(error, "strerror", None) or "it is not UTF-8 text"
    return InvalidFile(f"cannot read {source}: {reason}")


def _is_piped() -> bool:
    """True if standard input is a pipe or a file, not a terminal nor closed."""
    mode = _mode(_STDIN)
    return stat.S_ISFIFO(mode) or stat.S_ISREG(mode)


def _mode(descriptor: int) -> int:
    """The kind of file, as in stat(2); 0 where it is closed."""
    try:
        return os.fstat(descriptor).st_mode
    except OSError:
        return 0
