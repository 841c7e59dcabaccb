"""Writing logs in ROS's formats: MCAP, and bags of ROS 1 and ROS 2."""

import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any, Literal, TypeAlias

from lcmtools.bag.ros_definitions import RosVersion
from lcmtools.bag.ros_types import NO_TYPES, RecordedTypes, RosTypes
from lcmtools.errors import DecodeError, needing_extra
from lcmtools.messages.registry import Message
from lcmtools.names import as_utf_8
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.wire.packet import Packet

Encoding: TypeAlias = Literal["cdr", "ros1"]
Compression: TypeAlias = Literal["zstd", "lz4", "none"]

_LIBRARY = "lcmtools"
_TIMES_END = 2**32 * 10**9  # [ns] end of ROS 1's range, whose seconds have 32 bits
_STORAGE = {"db3": "SQLITE3", "mcap": "MCAP"}


class McapFile(AbstractContextManager["McapFile"]):
    """An MCAP file that is being written, with ROS's schemas, readable by Foxglove and PlotJuggler.

    The encoding is ROS 2's or ROS 1's; the compression applies to chunks; ``recorded`` are the
    types that a log keeps.

    Raises:
        MissingExtra: The library is missing.
    """

    def __init__(
        self,
        path: Path,
        encoding: Encoding = "cdr",
        compression: Compression = "zstd",
        recorded: RecordedTypes = NO_TYPES,
    ) -> None:
        with needing_extra("mcap", "MCAP needs"):
            from mcap.writer import CompressionType, Writer
        self._types = RosTypes(1 if encoding == "ros1" else 2, recorded)
        self._encoding = encoding
        self._file = path.open("wb")
        self._writer: Any = Writer(self._file, compression=CompressionType[compression.upper()])
        self._writer.start(profile="ros1" if encoding == "ros1" else "ros2", library=_LIBRARY)
        self._schemas: dict[str, int] = {}
        self._channels: dict[tuple[str, type[Message]], int] = {}

    def __exit__(self, *_: object) -> None:
        """Write the index, and close the file."""
        self._writer.finish()
        self._file.close()

    def add(self, packet: Packet, decoder: Decoder) -> None:
        """Write a message with the time of its arrival.

        Raises:
            DecodeError: It cannot be decoded, ROS cannot express its type, or another type with
                its name came before.
        """
        message = decoder.decode(packet)
        channel = self._channel(packet.channel, type(message), decoder.types(packet))
        data, time = self._types.serialize(message), _time(packet)
        self._writer.add_message(channel, log_time=time, data=data, publish_time=time)

    def _channel(self, topic: str, cls: type[Message], names: Sequence[str]) -> int:
        if (topic, cls) not in self._channels:
            one = self._types.schema(cls)
            if one.name not in self._schemas:
                number = self._writer.register_schema(one.name, one.form, one.text)
                self._schemas[one.name] = number
            # if other types have the same fields, the schema may be that of another one
            metadata = {"possible_types": ", ".join(names)} if len(names) > 1 else {}
            self._channels[topic, cls] = self._writer.register_channel(
                as_utf_8(topic), self._encoding, self._schemas[one.name], metadata
            )
        return self._channels[topic, cls]


def _time(packet: Packet) -> int:
    if not 0 <= packet.time < _TIMES_END:
        raise DecodeError("ROS cannot represent the time of their recording")
    return packet.time


@contextmanager
def database_errors() -> Iterator[None]:
    """Convert the errors of a ROS 2 bag's database, such as that of a full disk, to OSError."""
    try:
        yield
    except sqlite3.OperationalError as error:
        raise OSError(f"{error}") from error


class RosBag(AbstractContextManager["RosBag"]):
    """A bag that is being written: a file for ROS 1, a folder for ROS 2.

    Args:
        path: The bag's path, which must not exist yet.
        version: The version of ROS.
        storage: For ROS 2: "db3" or "mcap".
        recorded: The types that a log keeps.

    Raises:
        MissingExtra: The library is missing.
    """

    def __init__(
        self,
        path: Path,
        version: RosVersion,
        storage: str = "db3",
        recorded: RecordedTypes = NO_TYPES,
    ) -> None:
        self._types = RosTypes(version, recorded)
        self._writer: Any
        if version == 1:
            from rosbags.rosbag1 import Writer as Writer1

            self._writer = Writer1(path)
        else:
            from rosbags.rosbag2 import StoragePlugin
            from rosbags.rosbag2 import Writer as Writer2

            plugin = StoragePlugin[_STORAGE[storage]]
            self._writer = Writer2(path, version=9, storage_plugin=plugin)
        self._writer.open()
        self._connections: dict[tuple[str, type[Message]], Any] = {}

    def __exit__(self, *_: object) -> None:
        """Write the index, and close the bag."""
        self._writer.close()

    def add(self, packet: Packet, decoder: Decoder) -> None:
        """Write a message with the time of its arrival; raises errors as ``McapFile`` does."""
        message = decoder.decode(packet)
        key = packet.channel, type(message)
        if key not in self._connections:
            name = self._types.ros_type(type(message)).name
            self._connections[key] = self._writer.add_connection(
                as_utf_8(packet.channel), name, typestore=self._types.store
            )
        data = self._types.serialize(message)
        self._writer.write(self._connections[key], _time(packet), data)
