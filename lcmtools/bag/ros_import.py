"""Importing messages from ROS bags and MCAP files as LCM messages.

A type of lcmtools or the user with the same name and fields is used; all others are translated from
the bag's own definitions and compiled, like .msg files of a package.
"""

import struct
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from lcmtools.bag.ros_types import Conversion, RosVersion, parts, ros_store
from lcmtools.errors import LcmtoolsError, UnknownType, needing_extra, os_errors_as
from lcmtools.messages.registry import Message, Registry, message_class
from lcmtools.packages.user_types import user_types
from lcmtools.wire.log_index import RecordedType

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

_MCAP, _ROS_1 = b"\x89MCAP0", b"#ROSBAG V"
_SCHEMAS = ("ros1msg", "ros2msg", "ros2idl")
_LIBRARIES = ("mcap", "rosbags", "zstandard")
_BROKEN = (
    *(AssertionError, EOFError, KeyError, LookupError, OSError, ValueError, struct.error),
    *(RuntimeError, MemoryError, OverflowError),  # from lz4, and for impossible lengths
)
"""Errors that the libraries raise for damaged files, in addition to their own."""


class Imported(NamedTuple):
    """A ROS message as an LCM message."""

    topic: str
    message: Message
    time: int  # time of recording [ns since 1970]


@dataclass(slots=True)
class RosImport:
    """Reads bags; collects translated types and the reasons for messages left out."""

    types: dict[str, RecordedType] = field(default_factory=dict)  # the types that were translated
    # The reasons why messages were left out, with the number of messages.
    left_out: Counter[str] = field(default_factory=Counter)
    _classes: dict[str, type[Message]] = field(default_factory=dict)

    def read(self, path: Path) -> Iterator[Imported]:
        """Yield the messages of a ROS 1 or 2 bag or an MCAP file, in their order.

        Raises:
            MissingExtra: The library is missing.
            LcmtoolsError: The file is none of these, or damaged.
        """
        start = b"" if path.is_dir() else _start(path)
        with _readable(path):
            if start.startswith(_MCAP):
                yield from self._mcap(path)
            elif start.startswith(_ROS_1) or (path / "metadata.yaml").is_file():
                yield from self._bag(path)
            elif path.suffix == ".db3":
                raise LcmtoolsError(
                    f"{path} is part of a ROS 2 bag", f"name its folder: {path.parent}"
                )
            else:
                raise LcmtoolsError(f"{path} is neither a ROS bag nor an MCAP file")

    def _bag(self, path: Path) -> Iterator[Imported]:
        ros_store(None)  # raises MissingExtra if the library is missing
        from rosbags.highlevel import AnyReader

        default = None if path.is_file() else ros_store(2)
        with AnyReader([path], default_typestore=default) as reader:
            conversion = Conversion(reader.typestore)
            for connection, time, data in reader.messages():
                name = connection.msgtype
                made = reader.deserialize(data, name)
                yield self._message(connection.topic, conversion, name, made, time)

    def _mcap(self, path: Path) -> Iterator[Imported]:
        with needing_extra("mcap", "MCAP needs"):
            from mcap.reader import make_reader
        stores: dict[int, tuple[Conversion, str, Callable[..., Any]] | None] = {}
        with path.open("rb") as file:
            for schema, channel, message in make_reader(file).iter_messages():
                if channel.id not in stores:
                    stores[channel.id] = _reader(schema, channel)
                reader = stores[channel.id]
                if reader is None:
                    kind = channel.message_encoding or "an unknown encoding"
                    self.left_out[
                        f"{channel.topic} is encoded as {kind}, not in a format of ROS"
                    ] += 1
                    continue
                conversion, name, read = reader
                made = read(message.data, name)
                yield self._message(channel.topic, conversion, name, made, message.log_time)

    def _message(
        self, topic: str, conversion: Conversion, name: str, made: object, time: int
    ) -> Imported:
        cls = self._classes.get(name)
        if cls is None or not conversion.fits(cls, name):
            cls = self._classes[name] = self._class(conversion, name)
        return Imported(topic, conversion.to_lcm(cls, name, made), time)

    def _class(self, conversion: Conversion, name: str) -> type[Message]:
        """Return the LCM class for a ROS type, known or translated."""
        try:
            known = message_class(_lcm_name(name))
        except UnknownType:
            known = None
        if known is not None and conversion.fits(known, name):
            return known
        types = [*_translated(conversion.store, name)]
        source = user_types().compiled_types(types)
        if source.problems:
            raise source.problems[0].error()
        for one in types:
            self.types[one.name] = replace(one, fingerprint=source.fingerprints[one.name])
        return Registry([source]).message_class(_lcm_name(name))


def _reader(
    schema: Any,  # noqa: ANN401 - from a library that is imported when needed
    channel: Any,  # noqa: ANN401 - likewise
) -> tuple[Conversion, str, Callable[..., Any]] | None:
    """Return an MCAP channel's types, its type's name, and the function that reads messages."""
    if schema is None or schema.encoding not in _SCHEMAS:
        return None
    store = ros_store(None)
    from rosbags.typesys import get_types_from_idl, get_types_from_msg

    package, _, short = schema.name.rpartition("/")
    name = f"{package.removesuffix('/msg')}/msg/{short}"
    text = schema.data.decode()
    if schema.encoding == "ros2idl":
        store.register(get_types_from_idl(text))
    else:
        version: RosVersion = 1 if schema.encoding == "ros1msg" else 2
        known, found = ros_store(version).fielddefs, get_types_from_msg(text, name)
        times = [one for one in known if one.startswith("builtin_interfaces/")]
        store.register({**{one: known[one] for one in times}, **found})
    read = store.deserialize_ros1 if channel.message_encoding == "ros1" else store.deserialize_cdr
    return Conversion(store), name, read


def _translated(store: "Typestore", name: str) -> Iterator[RecordedType]:
    """Yield a ROS type and the types of its fields as equivalent .msg files."""
    for one in dict.fromkeys(parts(name, store.fielddefs)):
        if not one.startswith("builtin_interfaces/") and one != "std_msgs/msg/Header":
            text, _ = store.gendefhash(one, {}, 1)  # with ROS 1's names for times
            yield RecordedType(_lcm_name(one), 0, f"{one}.msg", text)


def _lcm_name(name: str) -> str:
    return name.replace("/msg/", "/")


def _start(path: Path) -> bytes:
    with os_errors_as(f"cannot read {path}"), path.open("rb") as file:
        return file.read(16)


@contextmanager
def _readable(path: Path) -> Iterator[None]:
    """Turn the libraries' errors for damaged files into one-line errors."""
    try:
        yield
    except LcmtoolsError:
        raise
    except Exception as error:
        is_of_library = type(error).__module__.partition(".")[0] in _LIBRARIES
        if not (is_of_library or isinstance(error, _BROKEN)):
            raise
        reason = str(error).partition("\n")[0] or type(error).__name__
        raise LcmtoolsError(f"{path} is damaged, or of an unknown kind: {reason}") from error
