"""The topics and fields that a panel offers for selection."""

from collections.abc import Callable, Iterator
from itertools import islice

from lcmtools.errors import LcmtoolsError
from lcmtools.gui.protocol import Json, MalformedRequest
from lcmtools.gui.source import Source
from lcmtools.gui.streams.image import TYPES
from lcmtools.gui.streams.steer import is_velocity
from lcmtools.messages.definition import array_type
from lcmtools.messages.fields import fields, is_time
from lcmtools.messages.registry import Message, message_class
from lcmtools.observe.channels.rows import ChannelRow

_MOST_FIELDS = 300  # of one type
_DEEPEST = 6  # levels of nested messages

_KINDS: dict[str, Callable[[str], bool]] = {
    "any": lambda _: True,
    "velocity": is_velocity,
    "image": TYPES.__contains__,
}


def topics(source: Source, *, kind: str) -> Json:
    """Return the topics for a kind of messages, each with its type."""
    if kind not in _KINDS:
        raise MalformedRequest(f"there is no kind of topics '{kind[:40]}'")
    return [_choice(row) for row in source.latest.rows if any(map(_KINDS[kind], row.types[:1]))]


def numbers(source: Source, *, text: str = "") -> Json:
    """Return the topics; if ``text`` begins with one, its fields with numbers."""
    rows = source.latest.rows
    begun = [row for row in rows if row.types and text.startswith(tuple(_begun(row)))]
    if not begun:
        return [_choice(row) for row in rows]
    row = max(begun, key=lambda one: len(one.channel))
    try:
        cls = message_class(row.types[0])
    except LcmtoolsError:
        return []
    fields = islice(number_fields(cls), _MOST_FIELDS)
    return [{"value": f"{row.channel}/{path}", "detail": about} for path, about in fields]


def number_fields(cls: type[Message], prefix: str = "", deep: int = 0) -> Iterator[tuple[str, str]]:
    """Yield the paths of a type's fields with numbers, each with its type."""
    for field in fields(cls):
        path = f"{prefix}{field.name}"
        inner = field.message_class
        if inner is None or is_time(inner):
            if field.type != "string" and not field.is_bytes:
                yield path, array_type(field.type, field.dimensions)
        elif deep < _DEEPEST:
            yield from number_fields(inner, f"{path}{'[0]' * field.depth}.", deep + 1)


def _begun(row: ChannelRow) -> Iterator[str]:
    return (f"{row.channel}{mark}" for mark in "./[")


def _choice(row: ChannelRow) -> Json:
    return {"value": row.channel, "detail": row.types[0] if row.types else ""}
