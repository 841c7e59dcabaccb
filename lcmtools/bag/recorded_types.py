"""The definitions of message types, as stored with a log."""

from collections.abc import Iterable
from contextlib import suppress
from pathlib import PurePath
from zlib import crc32

from lcmtools.errors import LcmtoolsError
from lcmtools.messages.fields import parts
from lcmtools.messages.registry import Message, fingerprint, type_name, versions
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.packages.user_types import source_file, source_text
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
            found.append(_recorded(kind))
    return found


def _recorded(kind: type[Message]) -> RecordedType:
    name = type_name(kind)
    file = PurePath(source_file(kind))
    path = PurePath(name.rpartition("/")[0], file.name)
    if any(len(versions(type_name(one))) > 1 for one in parts(kind)):
        path = crc32(str(file.parent).encode()).to_bytes(4, "big").hex() / path  # beside its parts
    return RecordedType(name, fingerprint(kind), str(path), source_text(kind) + "\n")
