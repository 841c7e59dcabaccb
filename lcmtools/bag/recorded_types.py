"""The definitions of message types, as stored with a log."""

from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import PurePath
from zlib import crc32

from lcmtools.errors import LcmtoolsError
from lcmtools.messages.enums import EnumType, enum_name
from lcmtools.messages.fields import fields, parts
from lcmtools.messages.registry import Message, fingerprint, type_name, versions
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.packages.user_types import read_source, source_file
from lcmtools.wire.log_index import RecordedType
from lcmtools.wire.packet import Packet


def recorded_types(packets: Iterable[Packet], decoder: Decoder) -> list[RecordedType]:
    """Return the types of messages and of their fields, as far as known here."""
    known: dict[type[Message], None] = {}
    for packet in packets:
        with suppress(LcmtoolsError):  # an unknown type does no harm to the log
            known.update(dict.fromkeys(parts(decoder.message_class(packet))))
    found: list[RecordedType] = []
    for kind in known:
        with suppress(LcmtoolsError):  # its file does not exist here
            found += _recorded(kind)
    return list(dict.fromkeys(found))


def _recorded(kind: type[Message]) -> Iterator[RecordedType]:
    """Yield a type, and the enums of its fields."""
    place = PurePath()
    if any(len(versions(type_name(one))) > 1 for one in parts(kind)):
        folder = str(PurePath(source_file(kind)).parent).encode()
        place = PurePath(f"{crc32(folder):08x}")  # beside its parts
    own = type_name(kind), fingerprint(kind), source_file(kind)
    enums = [part.type.cls for part in fields(kind) if isinstance(part.type, EnumType)]
    named = [(enum_name(one), one.__hash_number__, one.__file__) for one in enums]
    for name, number, file in (own, *named):
        path = place / name.rpartition("/")[0] / PurePath(file).name
        yield RecordedType(name, number, str(path), read_source(file, name) + "\n")
