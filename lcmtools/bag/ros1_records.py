"""Reading a ROS 1 bag from front to back, without the index that it gets when it is closed."""

from collections.abc import Iterator
from io import BytesIO
from typing import BinaryIO, NamedTuple

_SIZE = 4  # of a length [byte]


class Topic(NamedTuple):
    """A topic of a bag."""

    name: str
    type: str
    definition: str


def unindexed_messages(file: BinaryIO) -> Iterator[tuple[Topic | None, int, bytes]]:
    """Yield the topics, times [ns since 1970] and data of messages, in the order of the file.

    The topic is None if the file does not describe it. Errors of rosbags are raised at the first
    damage.
    """
    file.seek(0)
    file.readline()  # the version
    yield from _messages(file, {})


def _messages(
    file: BinaryIO, topics: dict[int, Topic]
) -> Iterator[tuple[Topic | None, int, bytes]]:
    from rosbags.rosbag1.reader import Header, RecordType, decompressors, read_bytes

    while file.read(1):
        file.seek(-1, 1)
        header = Header.read(file)
        size = read_bytes(file, _SIZE)
        length = int.from_bytes(size, "little")
        data, kind = file.read(length), header.get_uint8("op")
        if kind == RecordType.CHUNK:
            plain = decompressors[header.get_string("compression")](data)
            yield from _messages(BytesIO(plain), topics)
        elif kind == RecordType.CONNECTION:
            about = Header.read(BytesIO(size + data))
            name, text = about.get_string("type"), about.get_string("message_definition")
            topics[header.get_uint32("conn")] = Topic(header.get_string("topic"), name, text)
        elif kind == RecordType.MSGDATA and len(data) == length:
            topic = topics.get(header.get_uint32("conn"))
            yield topic, header.get_time("time"), data
