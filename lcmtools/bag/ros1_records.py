"""Reading a ROS 1 bag: its chunks, and from front to back, without the index of a closed bag."""

from collections.abc import Iterator
from functools import lru_cache, partial
from io import BytesIO
from typing import TYPE_CHECKING, BinaryIO, NamedTuple

from lcmtools.bag.mcap_reading import decompressed_chunk

if TYPE_CHECKING:  # an extra
    from rosbags.rosbag1 import Reader

_SIZE = 4  # of a length [byte]


class Topic(NamedTuple):
    """A topic of a bag."""

    name: str
    type: str
    definition: str
    is_latched: bool


def bound_chunks(reader: "Reader") -> None:
    """Let an open bag refuse, with a ValueError, chunks that are too large when unpacked.

    The last two stay unpacked, because the times of messages may alternate between two.
    """
    from rosbags.rosbag1.reader import decompressors

    unpack = lru_cache(2)(decompressed_chunk)
    kinds = {function: kind for kind, function in decompressors.items()}
    reader.chunks = {
        place: chunk._replace(decompressor=partial(unpack, kinds[chunk.decompressor]))
        for place, chunk in reader.chunks.items()
    }


def unindexed_messages(file: BinaryIO) -> Iterator[tuple[Topic | None, int, bytes]]:
    """Yield the topics, times [ns since 1970] and data of messages, in the order of the file.

    The topic is None if the file does not describe it. Errors of rosbags are raised at the first
    damage.
    """
    file.seek(0)
    file.readline()  # the version
    yield from _messages(file, {})


def _messages(
    file: BinaryIO, topics: dict[int, Topic], *, is_chunk: bool = False
) -> Iterator[tuple[Topic | None, int, bytes]]:
    from rosbags.rosbag1.reader import Header, RecordType, read_bytes

    while file.read(1):
        file.seek(-1, 1)
        header = Header.read(file)
        prefix = read_bytes(file, _SIZE)
        length = int.from_bytes(prefix, "little")
        data, kind = file.read(length), header.get_uint8("op")
        if kind == RecordType.CHUNK and not is_chunk:
            plain = decompressed_chunk(header.get_string("compression"), data)
            yield from _messages(BytesIO(plain), topics, is_chunk=True)
            if len(plain) != (size := header.get_uint32("size")):
                raise ValueError(f"a chunk has {len(plain)} bytes instead of {size}")
        elif kind == RecordType.CONNECTION:
            about = Header.read(BytesIO(prefix + data))
            name, text = about.get_string("type"), about.get_string("message_definition")
            is_latched = about.get("latching") == b"1"
            topic = Topic(header.get_string("topic"), name, text, is_latched)
            topics[header.get_uint32("conn")] = topic
        elif kind == RecordType.MSGDATA and len(data) == length:
            yield topics.get(header.get_uint32("conn")), header.get_time("time"), data
