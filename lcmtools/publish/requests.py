"""What a service is to be asked: from the words of a command line, a file or standard input."""

import re
import select
import stat
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TextIO

from lcmtools.cli.output import talk
from lcmtools.cli.service.offered import Offered, class_of
from lcmtools.errors import InvalidFile, LcmtoolsError, UnknownType, UsageError, ValueMismatch
from lcmtools.messages.fields import visible_fields
from lcmtools.messages.message_template import MessageTemplate
from lcmtools.messages.registry import Message, ServiceType, service_class, service_name
from lcmtools.messages.yaml_input import draft_from_values, drafts_from_lines

Drafts = list[MessageTemplate[Message]]

_TYPE = re.compile(r"[A-Za-z]\w*[/.](srv[/.])?[A-Za-z]\w*", re.ASCII)
_PATIENCE = 2.0  # [s] for standard input before the person is told what is waited for


def split_type(service: Offered, words: Sequence[str]) -> tuple[type[ServiceType], list[str]]:
    """The type of a call and its values: the first word may be a type, as ros2 wants it.

    Raises:
        UsageError: The type is unknown, or not the service's.
        LcmtoolsError: The type that is announced is not known here.
    """
    announced = service.types[0] if service.types else ""
    if not words or not _is_type(service, words[0]):
        return class_of(service), list(words)
    named = service_name(words[0])
    if announced and named != announced:
        raise UsageError(f"{service.name} is of type {announced}, not {named}", "leave it out")
    return service_class(named), list(words[1:])


def read_requests(kind: type[Message], values: Sequence[str], file: str | None) -> Drafts:
    """The requests to send; everything is read and checked before anything is sent.

    Without values and a file, what is piped into the command is read, as rosservice does.

    Raises:
        UsageError: Values and a file are both given, or the file has no request.
        InvalidFile: The file cannot be read.
        ValueMismatch: A value does not fit its field.
    """
    if file is not None and values:
        raise UsageError("values and -f exclude each other", "use one of them")
    if values or not visible_fields(kind):
        return [draft_from_values(kind, values)]
    if file is None:
        piped = _read(kind, sys.stdin, "standard input") if _is_piped(sys.stdin) else []
        return piped or [draft_from_values(kind, ())]
    requests = _read_file(kind, file)
    if not requests:
        source = "standard input" if file == "-" else file
        raise UsageError(f"{source} has no request in it", "write YAML documents, separated by ---")
    return requests


def _is_type(service: Offered, word: str) -> bool:
    """Whether a word is a type, and no value; "maps/yard" is one where a text is asked for."""
    try:
        named = service_name(word)
    except UnknownType:
        return bool(_TYPE.fullmatch(word)) and "/" in word and not _begins_with_text(service)
    return "/" in word or "." in word or named in service.types


def _begins_with_text(service: Offered) -> bool:
    """Whether the first field of a service's request is a text."""
    try:
        first = visible_fields(class_of(service).Request)[:1]
    except LcmtoolsError:
        return False
    return any(field.type == "string" for field in first)


def _read_file(kind: type[Message], file: str) -> Drafts:
    if file == "-":
        return _read(kind, sys.stdin, "standard input")
    try:
        with Path(file).open(encoding="utf-8") as stream:
            return _read(kind, stream, file)
    except OSError as error:
        raise InvalidFile(f"cannot read {file}: {error.strerror or error}") from error


def _read(kind: type[Message], stream: TextIO, source: str) -> Drafts:
    try:
        lines = (line.rstrip("\n") for line in _patiently(stream))
        return [draft for draft in drafts_from_lines(kind, lines) if draft is not None]
    except UnicodeDecodeError:
        raise InvalidFile(f"cannot read {source}: it is not UTF-8 text") from None
    except ValueMismatch as mismatch:
        raise ValueMismatch(f"{source}: {mismatch.what}", mismatch.hint) from None


def _patiently(stream: TextIO) -> Iterator[str]:
    """The lines of a stream; says so where the first one takes long."""
    if stream is sys.stdin and _has_descriptor(stream):
        ready, _, _ = select.select([stream], [], [], _PATIENCE)
        if not ready:
            talk("waiting for requests on standard input")
    yield from stream


def _is_piped(stream: TextIO) -> bool:
    """Whether a stream is a pipe or a file: not a terminal, and not nothing at all."""
    if not _has_descriptor(stream):
        return False
    import os

    mode = os.fstat(stream.fileno()).st_mode
    return stat.S_ISFIFO(mode) or stat.S_ISREG(mode)


def _has_descriptor(stream: TextIO) -> bool:
    try:
        return stream.fileno() >= 0
    except (OSError, ValueError):  # closed, or a test's
        return False
