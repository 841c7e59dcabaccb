"""The ROS types for LCM types, and conversion of messages in both directions.

If ROS has a type with the same name and fields, ROS's own is used, so that its tools know it; all
others are described by their fields, or as in the bag from which they were imported. The
differences are length fields, which ROS does not have; the sign of numbers, which LCM always has;
names that lcm-gen needs; and three spellings: ``nsec`` for ``nanosec``, upper case in ROS 1's
CameraInfo, and ``seq`` in a header, which ROS 2 does not have.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import prod
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeAlias

from lcmtools.bag.ros_definitions import (
    FILLER,
    Definitions,
    RosVersion,
    check_size,
    nested_types,
    original_text,
    parts,
    renamed_fields,
)
from lcmtools.bag.ros_numbers import (
    Change,
    Conversions,
    array_conversions,
    flat,
    holds,
    number_conversions,
)
from lcmtools.errors import DecodeError, InvalidFile, needing_extra
from lcmtools.messages.fields import Field, fields, holds_itself, is_time, length_values
from lcmtools.messages.registry import Message, fingerprint, type_name
from lcmtools.wire.log_index import RecordedType

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

RecordedTypes: TypeAlias = Mapping[str, RecordedType]  # by name
NO_TYPES: RecordedTypes = MappingProxyType({})
_Convert: TypeAlias = Callable[[Any], Any]
_Described: TypeAlias = Any  # as in rosbags: a kind, and its content

_HOLD_TIMES = ("std_msgs/msg/Time", "std_msgs/msg/Duration")
_TIME = "builtin_interfaces/msg/Time"
_SAME = {"bool": "bool", "float32": "float32", "float64": "float64", "string": "string"}


@dataclass(frozen=True, slots=True)
class RosType:
    """A ROS type."""

    name: str  # in ROS 2's spelling: "sensor_msgs/msg/LaserScan"
    definition: str  # its fields, and those of the types of its fields, as in bags
    digest: str  # the MD5 sum that ROS 1 compares


@dataclass(frozen=True, slots=True)
class Schema:
    """A type as expected by MCAP and Foxglove: its name, the format of its text, and the text."""

    name: str  # in the ROS version's spelling
    form: str  # "ros1msg" or "ros2msg"
    text: bytes


@dataclass(frozen=True, slots=True)
class _Pair:
    """A field of a type, in LCM and in ROS."""

    lcm_name: str
    ros_name: str
    to_ros: _Convert
    to_lcm: _Convert
    array: Field | None = None  # an array of several dimensions, which ROS has as one


def ros_store(version: RosVersion | None) -> "Typestore":
    """Return the types of a ROS version; for None, an empty store.

    Raises:
        MissingExtra: The library for ROS's formats is missing.
    """
    with needing_extra("mcap", "ROS's formats need"):
        from rosbags.typesys import Stores, get_typestore
    known = {None: Stores.EMPTY, 1: Stores.ROS1_NOETIC, 2: Stores.LATEST}
    return get_typestore(known[version])


def ros_distributions(version: RosVersion) -> Iterator[Definitions]:
    """Yield the types of the distributions of a version of ROS, the newest first.

    Raises:
        MissingExtra: The library for ROS's formats is missing.
    """
    known = ros_store(version).fielddefs
    if version == 1:
        from rosbags.interfaces import Nodetype

        unsigned = Nodetype.BASE, ("uint32", 0)  # in the library, seconds are those of ROS 2
        yield {**known, _TIME: ([], [("sec", unsigned), known[_TIME][1][1]])}
        return
    yield known
    from rosbags.typesys import Stores, get_typestore

    for older in (Stores.ROS2_JAZZY, Stores.ROS2_HUMBLE, Stores.ROS2_FOXY, Stores.ROS2_DASHING):
        yield get_typestore(older).fielddefs


class Conversion:
    """Conversion between messages of LCM classes and of the types in a store.

    ``changes`` collects the numbers that conversion to LCM has changed. A byte of ROS is signed in
    version 1, and unsigned in version 2.
    """

    def __init__(self, store: "Typestore", version: RosVersion) -> None:
        self.store = store
        self.version = version
        self.changes: list[Change] = []
        self._pairs: dict[tuple[type[Message], str], tuple[_Pair, ...]] = {}

    def fits(self, cls: type[Message], name: str) -> bool:
        """Return whether a ROS type has the fields of a class."""
        if name not in self.store.fielddefs:
            return False
        inner = self._inner(cls, name)
        return self.fits(cls, inner) if inner else self._find(cls, name) is not None

    def to_ros(self, cls: type[Message], name: str, message: Message) -> object:
        """Convert a message to a ROS type that fits its class."""
        if inner := self._inner(cls, name):
            held: Any = self.to_ros(cls, inner, message)
            return self.store.types[name](held)
        pairs = self._find(cls, name) or ()
        values = {pair.ros_name: pair.to_ros(getattr(message, pair.lcm_name)) for pair in pairs}
        return self.store.types[name](**values or self._filler(name))

    def to_lcm(self, cls: type[Message], name: str, message: object) -> Message:
        """Convert a message of a ROS type that fits a class to that class."""
        if inner := self._inner(cls, name):
            return self.to_lcm(cls, inner, message.data)  # type: ignore[attr-defined] # see there
        made = cls()
        for pair in self._find(cls, name) or ():
            value = pair.to_lcm(getattr(message, pair.ros_name))
            if pair.array:
                value = _shaped(value, length_values(made, pair.array))
            setattr(made, pair.lcm_name, value)
        return made

    def _inner(self, cls: type[Message], name: str) -> str | None:
        """Return the time in ROS 1's std_msgs/Time, which LCM's is itself; None for other types."""
        if not is_time(cls) or name not in _HOLD_TIMES:
            return None
        return next((one for one in nested_types(self.store.fielddefs[name])), None)

    def _filler(self, name: str) -> dict[str, Any]:
        return dict.fromkeys((field for field, _ in self.store.fielddefs[name][1]), 0)

    def _find(self, cls: type[Message], name: str) -> "tuple[_Pair, ...] | None":
        key = cls, name
        if key not in self._pairs:
            found = self._matched(cls, name)
            if found is None:
                return None
            self._pairs[key] = found
        return self._pairs[key]

    def _matched(self, cls: type[Message], name: str) -> "tuple[_Pair, ...] | None":
        """Return the fields of a type in LCM and ROS; None if they do not fit."""
        from rosbags.typesys.base import normalize_fieldname

        theirs = {
            spelled: one for spelled, one in self.store.fielddefs[name][1] if spelled != FILLER
        }
        names = {part.name for part in fields(cls)}
        renamed = {ours: one for one, ours in renamed_fields(theirs.items()).items()}
        renamed = {ours: one for ours, one in renamed.items() if ours in names}
        pairs: list[_Pair] = []
        for part in fields(cls):
            known = [one for one in theirs if one not in renamed.values()]
            spelled = renamed.get(part.name) or _spelling(cls, part.name, known)
            is_optional = part.name == "seq" and type_name(cls) == "std_msgs/Header"
            if spelled is None and (part.is_length or is_optional):
                continue
            converts = self._converts(part, theirs.pop(spelled)) if spelled else None
            if spelled is None or converts is None:
                return None
            array = part if part.depth > 1 else None
            pairs.append(_Pair(part.attribute, normalize_fieldname(spelled), *converts, array))
        return None if theirs else tuple(pairs)

    def _converts(self, part: Field, described: _Described) -> Conversions | None:
        """Return the conversions of a field's values; None if the field is not the same."""
        from rosbags.interfaces import Nodetype

        kind, of = described
        if not part.dimensions:
            return self._scalar(part, described)
        size = _fixed_size(part)
        if kind not in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            return None
        if (kind == Nodetype.ARRAY) != (size is not None) or size not in (None, of[1]):
            return None
        return self._array(part, of[0])

    def _scalar(self, part: Field, described: _Described) -> Conversions | None:
        from rosbags.interfaces import Nodetype

        kind, of = described
        if kind == Nodetype.NAME:
            return self._nested(part, of)
        name = of[0] if kind == Nodetype.BASE else ""
        if not holds(part.type, name):
            return (_as_it_is, _as_it_is) if _SAME.get(part.type) == name else None
        return number_conversions(part, self._number_type(name), self.changes)

    def _nested(self, part: Field, name: str) -> Conversions | None:
        cls = part.message_class
        if cls is None or not self.fits(cls, name):
            return None

        def to_lcm(value: Any) -> Message:  # noqa: ANN401 - a message of the library
            first = len(self.changes)
            made = self.to_lcm(cls, name, value)
            for number in range(first, len(self.changes)):
                change = self.changes[number]
                self.changes[number] = change._replace(field=f"{part.name}.{change.field}")
            return made

        return (lambda value: self.to_ros(cls, name, value)), to_lcm

    def _array(self, part: Field, element: _Described) -> Conversions | None:
        """Return the conversions of an array; ROS has it in one dimension, row by row."""
        one = self._scalar(part, element)
        if one is None:
            return None
        if part.message_class or part.type == "string":
            to_ros, to_lcm = one
            return (
                lambda values: [to_ros(value) for value in flat(values, part.depth)],
                lambda values: [to_lcm(value) for value in values],
            )
        return array_conversions(part, self._number_type(element[1][0]), self.changes)

    def _number_type(self, name: str) -> str:
        return "octet" if name == "byte" and self.version == 2 else name  # noqa: PLR2004 - ROS 2


class RosTypes(Conversion):
    """A ROS version's types for LCM types, found or described as they are needed.

    ``recorded`` are the types that a log keeps, by name; those that come from a bag are as there.

    Raises:
        MissingExtra: The library for ROS's formats is missing.
    """

    def __init__(self, version: RosVersion, recorded: RecordedTypes = NO_TYPES) -> None:
        super().__init__(ros_store(None), version)
        self._recorded = recorded
        self._known = Conversion(ros_store(version), version)
        self._names: dict[type[Message], str] = {}

    def ros_type(self, cls: type[Message]) -> RosType:
        """Return the ROS type for a class.

        Raises:
            DecodeError: ROS cannot express the class, or another class with its name came before.
        """
        name = self._add(cls)
        return RosType(name, *self.store.generate_msgdef(name, ros_version=self.version))

    def serialize(self, message: Message) -> bytes:
        """Serialize a message for ROS, in ROS 1's format or CDR; raises errors as ``ros_type``."""
        cls = type(message)
        name = self._add(cls)
        write = self.store.serialize_ros1 if self.version == 1 else self.store.serialize_cdr
        return bytes(write(self.to_ros(cls, name, message), name))

    def schema(self, cls: type[Message]) -> Schema:
        """Return the schema of a class; raises errors as ``ros_type``."""
        found = self.ros_type(cls)
        name = found.name.replace("/msg/", "/") if self.version == 1 else found.name
        return Schema(name, f"ros{self.version}msg", found.definition.encode())

    def deserialize(self, cls: type[Message], data: bytes) -> Message:
        """Return a message of a class from ROS's bytes; also raises errors as ``ros_type``.

        Raises:
            DecodeError: They are of another type, or truncated.
        """
        name = self._add(cls)
        read = self.store.deserialize_ros1 if self.version == 1 else self.store.deserialize_cdr
        try:
            return self.to_lcm(cls, name, read(data, name))
        except Exception as error:  # the library's readers are compiled from the type
            raise DecodeError(f"{len(data)} bytes are not a {type_name(cls)}: {error}") from error

    def _add(self, cls: type[Message]) -> str:
        """Return the name of the type for a class, which the store then has."""
        if cls in self._names:
            return self._names[cls]
        if holds_itself(cls):
            raise DecodeError(f"{type_name(cls)} contains itself, which ROS cannot represent")
        from rosbags.typesys.base import TypesysError

        name, known = ros_name(cls), self._known.store.fielddefs
        try:
            if self._known.fits(cls, name):
                self._register({one: known[one] for one in parts(name, known)})
            else:
                described = self._original(cls, name) or self._described(cls)
                check_size(name, {**self.store.fielddefs, name: described})
                self._register({name: described})
        except InvalidFile as error:
            raise DecodeError(error.what) from error
        except TypesysError as error:
            reason = f"another {type_name(cls)} came before, and ROS has one type of a name"
            raise DecodeError(reason) from error
        self._names[cls] = name
        return name

    def _register(self, described: dict[str, _Described]) -> None:
        """Add types to the store, whose library writes Python with their names, and runs it."""
        try:
            self.store.register(described)
        except (SyntaxError, TypeError, ValueError, LookupError) as error:
            what = f"ROS's library cannot read {', '.join(described)}: {error}"
            raise InvalidFile(what) from error

    def _original(self, cls: type[Message], name: str) -> _Described:
        """Return the definition of a type in the bag that it comes from; None if there is none."""
        one = self._recorded.get(type_name(cls))
        if one is None or one.fingerprint != fingerprint(cls) or one.path != f"{name}.msg":
            return None
        from rosbags.typesys import get_types_from_msg

        found = get_types_from_msg(original_text(one.source), name)
        for part in fields(cls):
            if part.message_class:
                self._add(part.message_class)
        trial = ros_store(None)
        trial.register({**self.store.fielddefs, **found})
        return found[name] if Conversion(trial, self.version).fits(cls, name) else None

    def _described(self, cls: type[Message]) -> _Described:
        return [], [*self._described_fields(cls)]

    def _described_fields(self, cls: type[Message]) -> "Iterator[tuple[str, _Described]]":
        """Yield the fields of a class in ROS's form; length fields only for several dimensions."""
        from rosbags.interfaces import Nodetype

        needed = {size for part in fields(cls) if part.depth > 1 for size in part.dimensions}
        for part in fields(cls):
            if part.is_length and part.name not in needed:
                continue
            element: _Described = (Nodetype.BASE, (part.type, 0))
            if part.message_class:
                element = (Nodetype.NAME, self._add(part.message_class))
            size = _fixed_size(part)
            if not part.dimensions:
                yield part.name, element
            elif size is None:
                yield part.name, (Nodetype.SEQUENCE, (element, 0))
            else:
                yield part.name, (Nodetype.ARRAY, (element, size))


def ros_name(cls: type[Message]) -> str:
    """Return the name of a class in ROS 2's spelling: acme.sense/ping is acme_sense/msg/ping.

    A type without a package is in "lcm".
    """
    package, _, short = type_name(cls).rpartition("/")
    return f"{package.replace('.', '_') or 'lcm'}/msg/{short}"


def _spelling(cls: type[Message], name: str, theirs: Sequence[str]) -> str | None:
    """Return a field's name in ROS; None if it has none."""
    spellings = [name, name.lower()]
    if is_time(cls):
        spellings += ["nanosec"] * name.startswith("n")
    return next((one for one in spellings if one in theirs), None)


def _fixed_size(part: Field) -> int | None:
    """Return the number of elements of an array over all dimensions; None if it varies."""
    sizes = [size for size in part.dimensions if isinstance(size, int)]
    return prod(sizes) if len(sizes) == part.depth else None


def _as_it_is(value: Any) -> Any:  # noqa: ANN401 - a value of any type
    return value


def _shaped(values: Sequence[Any], sizes: Sequence[int]) -> Any:  # noqa: ANN401 - nested lists
    """Return the elements of all rows as an array of several dimensions."""
    if len(sizes) == 1:
        return list(values)
    step = prod(sizes[1:])
    return [_shaped(values[row * step : (row + 1) * step], sizes[1:]) for row in range(sizes[0])]
