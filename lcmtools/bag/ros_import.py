"""Importing messages from ROS bags and MCAP files as LCM messages.

A type of lcmtools or the user with the same name and fields is used; all others are translated from
the bag's own definitions and compiled, like .msg files of a package. What cannot be read costs only
itself, and is named.
"""

from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from lcmtools.bag.damage import damage_text
from lcmtools.bag.edits import TopicChoice
from lcmtools.bag.ros_definitions import (
    NO_FORM,
    Definitions,
    RosVersion,
    lcm_name,
    nested_types,
    normal_name,
    read_definition,
    renamed_fields,
    ros_version,
    translated,
)
from lcmtools.bag.ros_reading import Channel, bag_messages
from lcmtools.bag.ros_types import Conversion, RosTypes, ros_distributions, ros_name, ros_store
from lcmtools.errors import InvalidFile, LcmtoolsError, MissingExtra, UnknownType
from lcmtools.graph.model import Endpoint, NodeInfo, Role
from lcmtools.graph.protocol import Announcement, encode_announcement
from lcmtools.messages.fields import parts as message_parts
from lcmtools.messages.registry import (
    Message,
    Registry,
    fingerprint,
    message_class,
    shipped_types,
    type_name,
)
from lcmtools.packages.user_types import source_file, source_text, user_types
from lcmtools.wire.log_index import RecordedNode, RecordedType

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

_ALL = TopicChoice()


class Imported(NamedTuple):
    """A ROS message as an LCM message."""

    topic: str
    message: Message
    time: int  # time of recording [ns since 1970]


@dataclass(slots=True)
class ImportReport:
    """The omissions and changes of an import."""

    damage: list[str] = field(default_factory=list)  # sentences on what cannot be read
    left_out: Counter[str] = field(default_factory=Counter)  # messages, by reason
    # The numbers that became negative, by topic and field, with the first as an example.
    changed: dict[tuple[str, str], tuple[int, int]] = field(default_factory=dict)
    # Fields with other names: of "a_msgs/Item.x_length" this is "x_length_".
    renamed: dict[str, str] = field(default_factory=dict)

    @property
    def is_complete(self) -> bool:
        """True if all messages are there as they were."""
        return not (self.damage or self.left_out or self.changed)

    def losses(self) -> list[str]:
        """Return a sentence for each reason why messages were left out."""
        counts = self.left_out.items()
        return [*self.damage, *(f"{count} messages are left out: {why}" for why, count in counts)]

    def changes(self) -> list[str]:
        """Return a sentence for each field with changed numbers."""
        return [
            f"{topic}: {name} is too large for LCM {count} times and became negative, "
            f"for example {example}"
            for (topic, name), (count, example) in self.changed.items()
        ]

    def to_lines(self) -> list[str]:
        """Return all of it in sentences."""
        renamed = [f"{name} is called {ours} in LCM" for name, ours in self.renamed.items()]
        return [*self.losses(), *self.changes(), *renamed]

    def to_json(self) -> dict[str, object]:
        """Return all of it for JSON."""
        return {"left_out": self.losses(), "changed": self.changes(), "renamed": self.renamed}


@dataclass(slots=True)
class _Reader:
    """Reads the messages of a channel."""

    conversion: Conversion
    name: str  # of the ROS type
    cls: type[Message]
    read: Callable[[bytes, str], object]
    fault: str = ""  # why the first message that could not be read could not


@dataclass(slots=True)
class RosImport:
    """Reads bags; collects translated types, and reports what was left out or changed."""

    types: dict[str, RecordedType] = field(default_factory=dict)  # the types that were translated
    report: ImportReport = field(default_factory=ImportReport)
    _latched: dict[str, int] = field(default_factory=dict)  # topics, with their first times
    _classes: dict[str, type[Message]] = field(default_factory=dict)
    _readers: dict[Channel, _Reader | str] = field(default_factory=dict)

    def read(self, path: Path, topics: TopicChoice = _ALL) -> Iterator[Imported]:
        """Yield the messages of a ROS 1 or 2 bag or an MCAP file, in their order.

        Raises:
            MissingExtra: The library is missing.
            InvalidFile: The file is none of these, or nothing in it can be imported.
            LcmtoolsError: A chosen topic is not there.
        """
        count, seen = 0, set[str]()
        for channel, time, data in bag_messages(path, self.report.damage.append):
            seen.add(channel.topic)
            if topics.has(channel.topic) and (message := self._message(channel, data)):
                count += 1
                if channel.is_latched:
                    self._latched.setdefault(channel.topic, time)
                yield Imported(channel.topic, message, time)
        if seen:
            topics.check(seen, f"its topics: {', '.join(sorted(seen))}")
        if not count:
            none = "no messages are selected" if seen else f"{path} has no messages"
            first, *others = self.report.losses() or [none]
            more = f" (and {len(others)} more reasons)" if others else ""
            raise InvalidFile(f"nothing is imported: {first}{more}")

    def nodes(self) -> Iterator[RecordedNode]:
        """Yield the announcement of a node that latches what the bags say was latched."""
        ends = tuple(Endpoint(one, Role.PUBLISHER, latched=True) for one in self._latched)
        if ends:
            node = NodeInfo("/bag_import", "bag_import", "", 0, endpoints=ends)
            said = encode_announcement(Announcement(node))
            yield RecordedNode(min(self._latched.values()), -1, said)

    def _message(self, channel: Channel, data: bytes) -> Message | None:
        """Return a message; None if it is left out."""
        if channel not in self._readers:
            self._readers[channel] = self._reader(channel, data)
        reader = self._readers[channel]
        if isinstance(reader, str):
            self.report.left_out[reader] += 1
            return None
        reader.conversion.changes.clear()
        try:
            ros = reader.read(data, reader.name)
            message = reader.conversion.to_lcm(reader.cls, reader.name, ros)
        except Exception as error:
            reason = damage_text(error)
            if reason is None:
                raise
            what = f"{channel.topic} has data that are no {lcm_name(reader.name)}: {reason}"
            reader.fault = reader.fault or what
            self.report.left_out[reader.fault] += 1
            return None
        for name, count, example in reader.conversion.changes:
            before, first = self.report.changed.get((channel.topic, name), (0, example))
            self.report.changed[channel.topic, name] = before + count, first
        return message

    def _reader(self, channel: Channel, data: bytes) -> "_Reader | str":
        """Return the reader of a channel; if it cannot be read, the reason."""
        if channel.encoding not in ("ros1", "cdr"):
            kind = channel.encoding or "an unknown encoding"
            return f"{channel.topic} is encoded as {kind}, not in a format of ROS"
        try:
            return self._made_reader(channel, data)
        except MissingExtra:
            raise
        except LcmtoolsError as error:
            reason: str | None = str(error)
        except Exception as error:  # for a strange definition
            reason = damage_text(error)
            if reason is None:
                raise
        return f"{channel.topic} has the type {channel.type or '(unknown)'}: {reason}"

    def _made_reader(self, channel: Channel, data: bytes) -> _Reader:
        channel = _with_definition(channel)
        store, name = _types_of(channel, data)
        conversion = Conversion(store, ros_version(channel))
        cls = self._classes.get(name)
        if cls is None or not conversion.fits(cls, name):
            cls = self._classes[name] = self._class(conversion, name, ros_version(channel))
        return _Reader(conversion, name, cls, _reading(store, channel))

    def _class(self, conversion: Conversion, name: str, version: RosVersion) -> type[Message]:
        """Return the LCM class for a ROS type, known or translated."""
        with suppress(UnknownType):
            known = message_class(lcm_name(name))
            if conversion.fits(known, name):
                return known
        types = [*_translated(conversion, name, version)]
        for one in types:
            if one.name in self.types and self.types[one.name].source != one.source:
                raise InvalidFile(f"another {one.name} came before, and a log has one of a name")
        source = user_types().compiled_types(types)
        if source.problems:
            raise InvalidFile(source.problems[0].what)
        found = Registry([source]).message_class(lcm_name(name))
        if not conversion.fits(found, name):
            raise InvalidFile("its fields cannot be translated")
        for one in types:
            self.types[one.name] = replace(one, fingerprint=source.fingerprints[one.name])
            self._note_renamed(one, conversion.store.fielddefs)
        return found

    def _note_renamed(self, one: RecordedType, known: Definitions) -> None:
        names = renamed_fields(known[one.path.removesuffix(".msg")][1])
        self.report.renamed |= {f"{one.name}.{theirs}": ours for theirs, ours in names.items()}


def _with_definition(channel: Channel) -> Channel:
    """Return a channel with the user's own definition of its type, if it and ROS have none."""
    version = ros_version(channel)
    known = any(normal_name(channel.type) in one for one in ros_distributions(version))
    if known or channel.definition.strip() or channel.form not in NO_FORM:
        return channel
    try:
        cls = message_class(lcm_name(channel.type))
    except UnknownType:
        return channel
    files = {kind: source_file(kind) for kind in message_parts(cls)}
    own = {
        type_name(kind): RecordedType(
            type_name(kind), fingerprint(kind), f"{ros_name(kind)}.msg", source_text(kind)
        )
        for kind, file in files.items()
        if file.endswith(".msg")
    }
    schema = RosTypes(version, own).schema(cls)
    return channel._replace(form=schema.form, definition=schema.text.decode())


def _types_of(channel: Channel, data: bytes) -> tuple["Typestore", str]:
    """Return the types of a channel, and the name of its own.

    Without a definition it is the type of the newest distribution of ROS that the message fits.
    """
    found = None
    for known in ros_distributions(ros_version(channel)):
        if found and found[1] not in known:
            continue
        name, definitions = read_definition(channel, known)
        store = ros_store(None)
        there = store.fielddefs  # times, which the library takes from ROS 2
        store.register({one: new for one, new in definitions.items() if one not in there})
        store.fielddefs.update(definitions)
        found = found or (store, name)
        if channel.definition.strip() or _can_read(store, channel, name, data):
            return store, name
    assert found
    return found


def _can_read(store: "Typestore", channel: Channel, name: str, data: bytes) -> bool:
    try:
        _reading(store, channel)(data, name)
    except Exception as error:
        if damage_text(error) is None:
            raise
        return False
    return True


def _reading(store: "Typestore", channel: Channel) -> Callable[[bytes, str], object]:
    return store.deserialize_ros1 if channel.encoding == "ros1" else store.deserialize_cdr


def _translated(conversion: Conversion, name: str, version: RosVersion) -> Iterator[RecordedType]:
    """Yield a ROS type, and the types of its fields that are not shipped, as .msg files."""
    known, waiting = conversion.store.fielddefs, [name]
    for one in waiting:
        yield RecordedType(lcm_name(one), 0, f"{one}.msg", translated(one, known, version))
        nested = dict.fromkeys(nested_types(known[one]))
        waiting += [each for each in nested if each not in waiting and not _ships(conversion, each)]


def _ships(conversion: Conversion, name: str) -> bool:
    """Return whether lcmtools ships a type that fits a ROS type."""
    shipped = shipped_types()
    if name.startswith("builtin_interfaces/"):
        return True
    return lcm_name(name) in shipped.fingerprints and conversion.fits(
        Registry([shipped]).message_class(lcm_name(name)), name
    )
