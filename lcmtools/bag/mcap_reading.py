"""Reading an MCAP file from front to back, as far as it goes; it need not have a summary.

Belongs here: records and chunks. Must not know what messages contain.
"""

import struct
from collections.abc import Callable, Iterator
from dataclasses import replace
from heapq import heappop, heappush
from io import BytesIO
from itertools import accumulate
from typing import Any, BinaryIO, Literal, NamedTuple

from lcmtools.bag.damage import damage_text
from lcmtools.errors import needing_extra
from lcmtools.wire.log_compression import Compression, decompressed_bytes

MAGIC = b"\x89MCAP0\r\n"
_HEAD = struct.Struct("<BQ")  # a record's kind and length
_TIME = struct.Struct("<Q")  # [ns since 1970]
_SCHEMA, _CHANNEL, _MESSAGE, _CHUNK, _DATA_END, _FOOTER = 3, 4, 5, 6, 15, 2
_READ = (_SCHEMA, _CHANNEL, _MESSAGE, _CHUNK, _DATA_END)
_TIME_AT = {_MESSAGE: 6, _CHUNK: 0}  # where a record has its (earliest) time [byte]
_NEVER = 2**64
_MOST_OF_CHUNK = 1 << 28  # bytes, when unpacked
_COMPRESSIONS: dict[str, Compression | Literal["bz2"]] = {
    "zstd": "zstd",
    "lz4": "lz4",
    "bz2": "bz2",
}
"""Compressions of chunks, bz2 in ROS 1 bags only."""


class McapMessage(NamedTuple):
    """A message; its channel and schema are those of the library, None if the file has none."""

    time: int  # of recording [ns since 1970]
    number: int  # its position among the messages of the file
    channel: Any
    schema: Any
    data: bytes


class _Record(NamedTuple):
    kind: int
    start: int  # of its content in the file [byte]
    length: int  # of its content [byte]
    time: int  # the earliest of its messages [ns since 1970]


class McapFileReader:
    """The messages of an MCAP file by time; ``on_damage`` is called with what cannot be read.

    Raises:
        MissingExtra: The library is missing.
    """

    def __init__(self, file: BinaryIO, on_damage: Callable[[str], object]) -> None:
        with needing_extra("mcap", "MCAP needs"):
            from mcap.data_stream import ReadDataStream
            from mcap.records import Channel, Chunk, Message, Schema
            from mcap.stream_reader import breakup_chunk
        self._file = file
        self._on_damage = on_damage
        self._size = file.seek(0, 2)
        self._stream, self._breakup = ReadDataStream, breakup_chunk
        self._classes: dict[int, Any] = {
            _SCHEMA: Schema,
            _CHANNEL: Channel,
            _CHUNK: Chunk,
            _MESSAGE: Message,
        }
        self._schemas: dict[int, Any] = {}
        self._channels: dict[int, Any] = {}
        self._count = 0

    def messages(self) -> Iterator[McapMessage]:
        """Yield the messages by time; those of one time in the order of the file."""
        found = [*self._records()]
        end = next((n for n, one in enumerate(found) if one.kind == _DATA_END), len(found))
        records = found[:end]
        for record in found[end:]:  # the summary, for channels in a chunk that is damaged
            for _ in self._read(record):
                pass
        earliest = [*accumulate((one.time for one in reversed(records)), min, initial=_NEVER)]
        waiting: list[McapMessage] = []
        for record, later in zip(records, earliest[-2::-1], strict=True):
            for message in self._read(record):
                heappush(waiting, message)
            while waiting and waiting[0].time <= later:
                yield heappop(waiting)

    def _records(self) -> Iterator[_Record]:
        """Yield the records before the footer, the last one perhaps incomplete."""
        at, file = len(MAGIC), self._file
        while at + _HEAD.size <= self._size:
            file.seek(at)
            kind, length = _HEAD.unpack(file.read(_HEAD.size))
            if kind == _FOOTER and self._ends_at(at + _HEAD.size + length):
                return
            start = at + _HEAD.size
            if kind in _READ:
                yield _Record(kind, start, length, self._time(kind, start))
            at = start + length
        self._on_damage(f"it is cut off at byte {self._size}")

    def _ends_at(self, end: int) -> bool:
        self._file.seek(end)
        return self._file.read(len(MAGIC)) == MAGIC

    def _time(self, kind: int, start: int) -> int:
        """Return the earliest time of a record's messages."""
        if kind not in _TIME_AT:
            return _NEVER
        self._file.seek(start + _TIME_AT[kind])
        time = self._file.read(_TIME.size)
        return int(_TIME.unpack(time)[0]) if len(time) == _TIME.size else _NEVER

    def _read(self, record: _Record) -> Iterator[McapMessage]:
        """Yield a record's messages; none of one that is cut off or damaged."""
        if record.start + record.length > self._size or record.kind == _DATA_END:
            return
        self._file.seek(record.start)
        try:
            found = self._parsed(record.kind, self._file.read(record.length))
        except Exception as error:
            reason = damage_text(error)
            if reason is None:
                raise
            self._on_damage(f"at byte {record.start - _HEAD.size} it is damaged: {reason}")
            return
        for one in found:
            if isinstance(one, self._classes[_SCHEMA]):
                self._schemas[one.id] = one
            elif isinstance(one, self._classes[_CHANNEL]):
                if one != self._channels.get(one.id):  # chunks repeat their channels
                    self._channels[one.id] = one
            else:
                channel = self._channels.get(one.channel_id)
                schema = self._schemas.get(channel.schema_id) if channel else None
                self._count += 1
                yield McapMessage(one.log_time, self._count, channel, schema, one.data)

    def _parsed(self, kind: int, content: bytes) -> list[Any]:
        """Return the library's records in one, a chunk or another."""
        length = (len(content),) if kind == _MESSAGE else ()
        found: Any = self._classes[kind].read(self._stream(BytesIO(content)), *length)
        if kind != _CHUNK:
            return [found]
        plain = decompressed_chunk(found.compression, found.data)
        if len(plain) != found.uncompressed_size:
            raise ValueError(f"it has {len(plain)} bytes instead of {found.uncompressed_size}")
        unpacked = replace(found, compression="", data=plain)
        return self._breakup(unpacked, validate_crc=True)


def decompressed_chunk(kind: str, data: bytes) -> bytes:
    """Return the content of a chunk, as far as it is there; ValueError if it is too large."""
    if kind in ("", "none"):
        return data
    if kind not in _COMPRESSIONS:
        raise ValueError(f"its compression {kind} is unknown")
    return decompressed_bytes(_COMPRESSIONS[kind], data, _MOST_OF_CHUNK)
