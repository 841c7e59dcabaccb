"""Reading the messages of ROS bags and MCAP files as bytes, as far as the files go.

Belongs here: files, folders and their formats. Must not know message types.
"""

import re
import sqlite3
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, suppress
from functools import lru_cache, partial
from io import BytesIO
from pathlib import Path, PurePath
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, BinaryIO, NamedTuple, TypeAlias
from urllib.parse import quote

from lcmtools.bag.damage import damage_text
from lcmtools.bag.mcap_reading import MAGIC as _MCAP
from lcmtools.bag.mcap_reading import McapFileReader, decompressed_chunk
from lcmtools.errors import InvalidFile, LcmtoolsError, needing_extra, os_errors_as
from lcmtools.folders import read_text
from lcmtools.formats.strict_yaml import read_file
from lcmtools.observe.reading.unpacking import fitting
from lcmtools.wire.datagram import MESSAGE_MAX
from lcmtools.wire.log_compression import decompressed, decompressed_bytes

if TYPE_CHECKING:
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


_ROS_1, _SQLITE, _ZSTD = b"#ROSBAG V", b"SQLite format 3\0", b"\x28\xb5\x2f\xfd"
_LFS = b"version https://git-lfs.github.com/spec/"
_METADATA = "metadata.yaml"
_MOST_METADATA = 20_000_000  # bytes; it lists topics and files
_ROS_1_FORM = "ros1", "ros1msg"
_STORAGE = re.compile(r"\.(?:db3|mcap)(?:\.zstd)?$")
_UNKNOWN = "(a topic that the file does not name)"
_DEFINITIONS = "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions"
_TOPICS = "SELECT id, name, type, serialization_format, {} FROM topics"
_QOS = "offered_qos_profiles"  # older bags do not have it
_LATCHED = re.compile(r"durability:\s*(?:1|transient_local)\b")
_MESSAGES = "SELECT topic_id, timestamp, data FROM messages ORDER BY timestamp"

OnDamage: TypeAlias = Callable[[str], object]  # called with a sentence on what cannot be read


class Channel(NamedTuple):
    """A topic with its type, as a bag describes it; "" for what it does not tell."""

    topic: str
    type: str
    encoding: str  # of its messages: "ros1" or "cdr", else not in a format of ROS
    form: str = ""  # of the type's definition: "ros1msg", "ros2msg", "ros2idl" or another
    definition: str = ""
    is_latched: bool = False  # "latching" of ROS 1, "transient local" of ROS 2


class BagMessage(NamedTuple):
    """A message as it is in a bag."""

    channel: Channel
    time: int  # of recording [ns since 1970]
    data: bytes


def bag_messages(path: Path, on_damage: OnDamage) -> Iterator[BagMessage]:
    """Yield the messages of a ROS 1 or 2 bag or an MCAP file, by time in each of its files.

    Raises:
        MissingExtra: The library is missing.
        InvalidFile: It is none of these, or cannot be read.
    """
    if path.is_dir():
        for file in _storage_files(path, on_damage):
            yield from _as_far_as_it_goes(file, _storage(file, on_damage), on_damage)
        return
    start = _start(path)
    if start.startswith(_MCAP):
        yield from _as_far_as_it_goes(path, _mcap(path, on_damage), on_damage)
    elif start.startswith(_ROS_1):
        yield from _as_far_as_it_goes(path, _ros_1(path, on_damage), on_damage)
    elif path.suffix == ".db3" or path.name == _METADATA:
        raise InvalidFile(f"{path} is part of a ROS 2 bag", f"name its folder: {path.parent}")
    else:
        raise InvalidFile(f"{path} is neither a ROS bag nor an MCAP file")


def _as_far_as_it_goes(
    path: Path, messages: Iterator[BagMessage], on_damage: OnDamage
) -> Iterator[BagMessage]:
    """Yield messages up to the first error for a damaged file."""
    try:
        yield from messages
    except InvalidFile as error:
        on_damage(str(error))
    except LcmtoolsError:
        raise
    except Exception as error:
        reason = damage_text(error)
        if reason is None:
            raise
        on_damage(f"{path} is damaged, or of an unknown kind: {reason}")


def _start(path: Path) -> bytes:
    """Return the first bytes of a file; raise InvalidFile for a pointer to one."""
    if path.exists() and not path.is_file():
        raise InvalidFile(f"{path} is not a file")
    with os_errors_as(f"cannot read {path}", kind=InvalidFile), path.open("rb") as file:
        start = file.read(len(_LFS))
    if start == _LFS:
        what = f"{path} is a pointer of Git LFS, not the file itself"
        raise InvalidFile(what, "fetch the file: git lfs pull")
    return start


def _mcap(path: Path, on_damage: OnDamage) -> Iterator[BagMessage]:
    known: dict[int, tuple[object, Channel]] = {}  # by identity, which an object kept here keeps
    with path.open("rb") as file:
        reader = McapFileReader(file, lambda text: on_damage(f"{path}: {text}"))
        for time, _, channel, schema, data in reader.messages():
            if id(channel) not in known:
                known[id(channel)] = channel, _mcap_channel(channel, schema)
            yield BagMessage(known[id(channel)][1], time, data)


def _mcap_channel(
    channel: Any,  # noqa: ANN401 - from a library that is imported when needed
    schema: Any,  # noqa: ANN401 - likewise
) -> Channel:
    if channel is None:
        return Channel(_UNKNOWN, "", "")
    about = channel.metadata
    is_latched = about.get("latching") == "1" or bool(_LATCHED.search(about.get(_QOS, "")))
    if schema is None:
        return Channel(channel.topic, "", channel.message_encoding, is_latched=is_latched)
    text = schema.data.decode("utf-8", "replace")  # those of other encodings are binary
    kind = schema.name, channel.message_encoding, schema.encoding, text
    return Channel(channel.topic, *kind, is_latched)


def _ros_1(path: Path, on_damage: OnDamage) -> Iterator[BagMessage]:
    with needing_extra("mcap", "ROS's formats need"):
        from rosbags.rosbag1 import Reader, ReaderError
    reader = Reader(path)
    try:
        reader.open()
    except ReaderError as error:
        on_damage(f"{path} is read without its index: {error}")
        with path.open("rb") as file:
            for topic, time, data in unindexed_messages(file):
                name, kind, text, is_latched = topic or (_UNKNOWN, "", "", False)
                channel = Channel(name, kind, *_ROS_1_FORM, text, is_latched)
                yield BagMessage(channel, time, data)
        return
    with closing(reader):
        bound_chunks(reader)
        channels = {}
        for one in reader.connections:
            is_latched = getattr(one.ext, "latching", None) == 1
            about = one.msgtype, *_ROS_1_FORM, one.msgdef.data
            channels[one.id] = Channel(one.topic, *about, is_latched)
        for connection, time, data in reader.messages():
            yield BagMessage(channels[connection.id], time, data)


def _storage_files(folder: Path, on_damage: OnDamage) -> list[Path]:
    """Return the files of a ROS 2 bag in order: those of its metadata, else those that are there.

    The rest of the metadata repeats what the files say, and need not agree with them.
    """
    metadata = folder / _METADATA
    listed = [folder / name for name in _listed(metadata)] if metadata.is_file() else []
    for file in listed:
        if not file.is_file():
            on_damage(f"{file} is missing, which {metadata} lists")
    there = [file for file in listed if file.is_file()] or sorted(
        (one for one in folder.iterdir() if _STORAGE.search(one.name)), key=_number
    )
    if not there:
        raise InvalidFile(f"{folder} is not a ROS 2 bag", "it has no .db3 or .mcap file")
    return there


def _listed(metadata: Path) -> list[str]:
    """Return the names of the files that a bag's metadata lists, none if it cannot be read."""
    _start(metadata)
    with suppress(InvalidFile, OSError, UnicodeDecodeError):
        root: Any = read_file(read_text(metadata, _MOST_METADATA), str(metadata))
        with suppress(LookupError, TypeError, AttributeError):
            names = root.plain()["rosbag2_bagfile_information"]["relative_file_paths"]
            return [PurePath(name).name for name in names]
    return []


def _number(file: Path) -> tuple[int, str]:
    """Return the number by which ROS 2 names a bag's files: bag_0.db3, bag_1.db3."""
    number = re.search(r"_(\d+)\.", file.name)
    return int(number[1]) if number else 0, file.name


def _storage(file: Path, on_damage: OnDamage) -> Iterator[BagMessage]:
    """Yield the messages of a file of a ROS 2 bag, which ROS 2 may have compressed."""
    with _plain_file(file) as (plain, start):
        if start.startswith(_MCAP):
            found = _mcap(plain, on_damage)
        elif start.startswith(_SQLITE):
            found = _sqlite(plain)
        else:
            raise ValueError("neither SQLite nor MCAP")
        for one in found:
            is_plain = not one.data.startswith(_ZSTD)
            data = one.data if is_plain else decompressed_bytes("zstd", one.data, MESSAGE_MAX)
            yield one._replace(data=data)


@contextmanager
def _plain_file(file: Path) -> Iterator[tuple[Path, bytes]]:
    """Give a file without compression, and its first bytes."""
    start = _start(file)
    if not start.startswith(_ZSTD):
        yield file, start
        return
    with TemporaryDirectory() as folder:
        plain = Path(folder, file.stem)
        with file.open("rb") as source, plain.open("wb") as target:
            target.writelines(fitting(decompressed("zstd", source), file))
        yield plain, _start(plain)


def _sqlite(file: Path) -> Iterator[BagMessage]:
    # Without a log of changes beside it, the file is complete and read without a lock.
    is_complete = not file.with_name(f"{file.name}-wal").exists()
    address = f"file:{quote(str(file))}?mode=ro{'&immutable=1' * is_complete}"
    with closing(sqlite3.connect(address, uri=True)) as base:
        tables = {name for (name,) in base.execute("SELECT name FROM sqlite_master")}
        definitions = (
            {name: (form, text) for name, form, text in base.execute(_DEFINITIONS)}
            if "message_definitions" in tables
            else {}
        )
        columns = {name for _, name, *_ in base.execute("PRAGMA table_info(topics)")}
        topics = base.execute(_TOPICS.format(_QOS if _QOS in columns else "''"))
        channels = {
            number: Channel(
                topic,
                kind,
                encoding,
                *definitions.get(kind, ("", "")),
                bool(_LATCHED.search(str(qos))),
            )
            for number, topic, kind, encoding, qos in topics
        }
        for number, time, data in base.execute(_MESSAGES):
            yield BagMessage(channels.get(number, Channel(_UNKNOWN, "", "")), time, data)
