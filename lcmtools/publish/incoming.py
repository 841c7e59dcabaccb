"""The messages that a command is to publish: from values, a file, or a stream as it comes.

Belongs here: reading them, and saying of what source and where an error is. Must not know YAML nor
what becomes of the messages.
"""

import itertools
import os
import select
import stat
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from lcmtools.cli.output import talk
from lcmtools.errors import InvalidFile, UsageError, ValueMismatch
from lcmtools.messages.documents import LONGEST
from lcmtools.messages.fields import visible_fields
from lcmtools.messages.message_template import MessageTemplate
from lcmtools.messages.registry import Message
from lcmtools.messages.yaml_input import draft_from_values, drafts_from_lines

_STDIN = 0
_STANDARD_INPUT = "standard input"
_BLOCK_BYTES = 1 << 16
_POLL = 0.02  # [s] between two looks at other things while nothing comes
_PATIENCE = 2.0  # [s] before the person is told that nothing comes


@dataclass(frozen=True, slots=True)
class Incoming:
    """What is to be published.

    Attributes:
        drafts: The messages; None where the next one has not come yet.
        is_file: They are in a file, and so known to be right, and to be no more.
        is_one: There is one message, and it may be sent again and again.
    """

    drafts: Iterator[MessageTemplate[Message] | None]
    is_file: bool = False
    is_one: bool = False

    @property
    def is_stream(self) -> bool:
        """Whether they come one by one, nobody knows how many."""
        return not (self.is_file or self.is_one)


def read_incoming(kind: type[Message], values: Sequence[str], file: str | None) -> Incoming:
    """The messages that a command line means; all of them are checked, unless it is a stream.

    Without values, a pipe's or a file's content on standard input is meant, as with rostopic.

    Raises:
        UsageError: Values and a file are both given, or the file has no message.
        InvalidFile: The file cannot be read.
        ValueMismatch: A value does not fit its field.
    """
    if file is not None and values:
        raise UsageError("values and -f exclude each other", "use one of them")
    if file == "-" or tuple(values) == ("-",):
        return _from_descriptor(kind, _STDIN, _STANDARD_INPUT)
    if file is not None:
        return _from_file(kind, file)
    if not values and visible_fields(kind) and _is_piped(_STDIN):
        return _from_pipe_or_default(kind)
    return _from_values(kind, values)


def _from_values(kind: type[Message], values: Sequence[str]) -> Incoming:
    return Incoming(iter([draft_from_values(kind, values)]), is_one=True)


def _from_file(kind: type[Message], file: str) -> Incoming:
    try:
        descriptor = os.open(file, os.O_RDONLY)
        if stat.S_ISDIR(os.fstat(descriptor).st_mode):
            os.close(descriptor)
            raise IsADirectoryError(21, "Is a directory")
    except (OSError, ValueError) as error:
        raise _unreadable(file, error) from error
    return _from_descriptor(kind, descriptor, file)


def _from_descriptor(kind: type[Message], descriptor: int, source: str) -> Incoming:
    mode = _mode(descriptor)
    if not mode:  # the bus would take its number
        raise InvalidFile(f"cannot read {source}: it is closed")
    drafts = _read(kind, descriptor, source)
    if not stat.S_ISREG(mode):
        return Incoming(_from_stream(drafts, source))
    found = list(drafts)
    if not found:
        raise _nothing_in(source)
    return Incoming(iter(found), is_file=True, is_one=len(found) == 1 and source != _STANDARD_INPUT)


def _from_pipe_or_default(kind: type[Message]) -> Incoming:
    """What comes on standard input; the type's default message where that is nothing."""
    drafts = _read(kind, _STDIN, _STANDARD_INPUT)
    for draft in _impatient(drafts, _STANDARD_INPUT):
        if draft is not None:
            return Incoming(_counted(itertools.chain([draft], drafts)))
    return _from_values(kind, ())


def _from_stream(
    drafts: Iterator[MessageTemplate[Message] | None], source: str
) -> Iterator[MessageTemplate[Message] | None]:
    """The messages of a stream; says so when none comes, and when there was none."""
    came = False
    for draft in _counted(_impatient(drafts, source)):
        came = came or draft is not None
        yield draft
    if not came:
        raise _nothing_in(source)


def _counted(
    drafts: Iterator[MessageTemplate[Message] | None],
) -> Iterator[MessageTemplate[Message] | None]:
    """The messages; an error after some of them says how many have been sent."""
    count = 0
    try:
        for draft in drafts:
            yield draft
            count += draft is not None
    except UsageError as error:
        if not count:
            raise
        sent = "1 message has" if count == 1 else f"{count} messages have"
        hint = f"{error.hint}; " if error.hint else ""
        raise BrokenOff(error.what, f"{hint}{sent} been sent") from None


class BrokenOff(UsageError):  # noqa: N818 - named for what happened, as in errors.py
    """A stream went wrong after some of its messages had been sent."""

    exit_code = 1


def _impatient(
    drafts: Iterator[MessageTemplate[Message] | None], source: str
) -> Iterator[MessageTemplate[Message] | None]:
    """The messages; the person is told when the first takes long."""
    start = time.monotonic()
    told = False
    for draft in drafts:
        if draft is None and not told and time.monotonic() - start >= _PATIENCE:
            talk(f"lcmtools pub: waiting for messages on {source}")
        told = told or draft is not None or time.monotonic() - start >= _PATIENCE
        yield draft


def _read(
    kind: type[Message], descriptor: int, source: str
) -> Iterator[MessageTemplate[Message] | None]:
    """The messages in a file or a stream.

    Raises:
        InvalidFile: It cannot be read.
        ValueMismatch: A message is wrong; it names the source.
    """
    try:
        yield from drafts_from_lines(kind, _lines(descriptor, source))
    except ValueMismatch as mismatch:
        raise ValueMismatch(f"{source}: {mismatch.what}", mismatch.hint) from None


def _lines(descriptor: int, source: str) -> Iterator[str | None]:
    """The lines of a file or a stream as they come; None where there is none for a moment."""
    rest = bytearray()
    while True:
        try:
            if not select.select([descriptor], [], [], _POLL)[0]:
                yield None
                continue
            block = os.read(descriptor, _BLOCK_BYTES)
        except OSError as error:
            raise _unreadable(source, error) from error
        *lines, last = block.split(b"\n")
        for line in lines:
            yield _text(bytes(rest) + line, source)
            rest.clear()
        rest += last
        if not block:
            yield _text(bytes(rest), source)
            return
        if len(rest) > LONGEST:
            raise InvalidFile(f"{source}: a line does not end")


def _text(line: bytes, source: str) -> str:
    try:
        return line.decode()
    except UnicodeDecodeError as error:
        raise _unreadable(source, error) from None


def _unreadable(source: str, error: Exception) -> InvalidFile:
    reason = getattr(error, "strerror", None) or "it is not UTF-8 text"
    return InvalidFile(f"cannot read {source}: {reason}")


def _nothing_in(source: str) -> UsageError:
    return UsageError(f"{source} has no message in it", "write YAML documents, separated by ---")


def _is_piped(descriptor: int) -> bool:
    """Whether somebody has put a pipe or a file there, not a terminal nor nothing at all."""
    mode = _mode(descriptor)
    return stat.S_ISFIFO(mode) or stat.S_ISREG(mode)


def _mode(descriptor: int) -> int:
    """What kind of file it is, as in stat(2); 0 where it is closed."""
    try:
        return os.fstat(descriptor).st_mode
    except OSError:
        return 0
