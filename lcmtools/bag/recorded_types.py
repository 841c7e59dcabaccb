"""The definitions of message types as a log keeps them."""

from collections.abc import Iterator
from pathlib import PurePath

from lcmtools.errors import LcmtoolsError
from lcmtools.messages.fields import fields
from lcmtools.messages.registry import Message, fingerprint, type_name
from lcmtools.packages.user_types import source_file, source_text
from lcmtools.wire.log_index import RecordedType


def recorded_types(kind: type[Message]) -> list[RecordedType]:
    """Return a type and those of its fields, as far as their files can be read."""
    found: dict[str, RecordedType] = {}
    for one in _parts(kind, set()):
        name = type_name(one)
        package = name.rpartition("/")[0]
        try:
            text = source_text(one) + "\n"
        except LcmtoolsError:
            continue
        path = f"{package}/{PurePath(source_file(name)).name}"
        found[name] = RecordedType(name, fingerprint(one), path, text)
    return list(found.values())


def _parts(kind: type[Message], known: set[type[Message]]) -> Iterator[type[Message]]:
    if kind in known:
        return
    known.add(kind)
    for part in fields(kind):
        if part.message_class:
            yield from _parts(part.message_class, known)
    yield kind
