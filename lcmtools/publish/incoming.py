"""Messages to publish and requests to send, from values, a file or a live stream.

Belongs here: reading them, and errors that name the source. Must not know YAML.
"""

import errno
import io
import itertools
import math
import os
import select
import stat
import time
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple, TypeAlias

from lcmtools.errors import InvalidFile, UsageError, ValueMismatch
from lcmtools.messages.documents import LONGEST
from lcmtools.messages.fields import visible_fields
from lcmtools.messages.message_template import MessageTemplate, draft_from_values, drafts_from_lines
from lcmtools.messages.registry import Message

Template: TypeAlias = MessageTemplate[Message]
Notify: TypeAlias = Callable[[str], None]

_BLOCK_BYTES = 1 << 16
_POLL = 0.02  # [s] between two returns to the caller while no message comes
_PATIENCE = 2.0  # [s] before the user is told that nothing has come


class Incoming(NamedTuple):
    """Messages to be sent."""

    templates: Iterator[Template | None]  # None if the next one has not come yet
    is_file: bool = False  # the messages are in a file, and all are read and checked
    is_one: bool = False  # there is a single message, which may be sent repeatedly

    @property
    def is_stream(self) -> bool:
        """True if the messages come one by one and their number is unknown."""
        return not (self.is_file or self.is_one)


def read_incoming(
    kind: type[Message],
    values: Sequence[str],
    file: str | None,
    notify: Notify,
    *,
    noun: str = "message",
) -> Incoming:
    """Return the messages of a command line, all checked unless they come from a stream.

    Without values, messages are read from a pipe or file on standard input, as with rostopic.

    Raises:
        UsageError: Values and a file are both given, or the file has no message.
        InvalidFile: The file cannot be read.
        ValueMismatch: A value does not fit its field.
    """
    if file is not None and values:
        raise UsageError("values and -f exclude each other", "use one of them")
    if file is not None or tuple(values) == ("-",):
        is_stdin = file is None or file == "-"
        return _Reader(kind, None if is_stdin else file, noun, notify).incoming()
    if not values and visible_fields(kind) and _is_piped():
        templates = _Reader(kind, None, noun, notify).templates()
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


class _Reader:  # reads messages from a file; None is standard input
    def __init__(self, kind: type[Message], file: str | None, noun: str, notify: Notify) -> None:
        self._kind = kind
        self._source = "standard input" if file is None else file
        self._noun = noun
        self._notify = notify
        self._is_stdin = file is None
        try:
            descriptor = 0 if file is None else os.open(file, os.O_RDONLY)
            self._file = io.FileIO(descriptor, closefd=file is not None)
        except (OSError, ValueError) as error:
            is_closed = self._is_stdin and getattr(error, "errno", 0) == errno.EBADF
            raise self._unreadable(error, "it is closed" if is_closed else "") from error

    def incoming(self) -> Incoming:
        templates = self.templates(may_be_empty=False)
        if not stat.S_ISREG(os.fstat(self._file.fileno()).st_mode):
            return Incoming(templates)
        found = [template for template in templates if template is not None]
        is_one = len(found) == 1 and not self._is_stdin
        return Incoming(iter(found), is_file=True, is_one=is_one)

    def templates(self, *, may_be_empty: bool = True) -> Iterator[Template | None]:
        """The messages; ``notify`` is called if the first takes long."""
        deadline = time.monotonic() + _PATIENCE
        is_empty = True
        try:
            for template in drafts_from_lines(self._kind, self._lines()):
                if template is not None:
                    deadline, is_empty = math.inf, False
                elif time.monotonic() >= deadline:
                    self._notify(f"waiting for {self._noun}s on {self._source}")
                    deadline = math.inf
                yield template
        except ValueMismatch as mismatch:
            raise ValueMismatch(f"{self._source}: {mismatch.what}", mismatch.hint) from None
        finally:
            self._file.close()
        if is_empty and not may_be_empty:
            hint = "write YAML documents, separated by ---"
            raise UsageError(f"{self._source} does not contain a {self._noun}", hint)

    def _lines(self) -> Iterator[str | None]:
        """The lines as they come; None while there is none."""
        rest = bytearray()
        while True:
            try:
                if not select.select([self._file], [], [], _POLL)[0]:
                    yield None
                    continue
                block = self._file.read(_BLOCK_BYTES)
            except OSError as error:
                raise self._unreadable(error) from error
            *lines, last = block.split(b"\n")
            for line in lines:
                yield self._text(bytes(rest) + line)
                rest.clear()
            rest += last
            if not block:
                yield self._text(bytes(rest))
                return
            if len(rest) > LONGEST:
                raise InvalidFile(f"{self._source}: a line does not end")

    def _text(self, line: bytes) -> str:
        try:
            return line.decode()
        except UnicodeDecodeError as error:
            raise self._unreadable(error) from None

    def _unreadable(self, error: Exception, reason: str = "") -> InvalidFile:
        reason = reason or getattr(error, "strerror", None) or "it is not UTF-8 text"
        return InvalidFile(f"cannot read {self._source}: {reason}")


def _is_piped() -> bool:
    """True if standard input is a pipe or a file, not a terminal and not closed."""
    try:
        mode = os.fstat(0).st_mode
    except OSError:
        return False
    return stat.S_ISFIFO(mode) or stat.S_ISREG(mode)
