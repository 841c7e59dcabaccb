"""What a type that nobody knows probably is: a known one with a field more, less or changed.

A fingerprint is computed from the names and types of fields (lcm-proj/lcm, lcmgen/lcmgen.c), so it
can be computed for known types with one field changed, and compared. Pure.
"""

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cache
from itertools import chain, permutations

from lcmtools.messages.fields import PRIMITIVES, Field, fields
from lcmtools.messages.registry import Message, fingerprint, message_class, type_name, type_names

_MASK = (1 << 64) - 1
_SIGN = 1 << 63
_START = 0x12345678
_FEW = 5  # fields have few orders
_LCM_NAMES = {ours: lcm for lcm, ours in PRIMITIVES.items()}
_USUAL_FIRST = (("seq", "int32"), ("utime", "int64"), ("timestamp", "int64"), ("id", "int32"))
_USUAL_NAMES = frozenset(
    [
        "value",
        "values",
        "text",
        "msg",
        "message",
        "content",
        "contents",
        "payload",
        "string",
        "str",
        "number",
        "num",
        "count",
        "result",
        "speed",
        "vel",
        "velocity",
        "pos",
        "position",
        "rot",
        "rotation",
        "orientation",
        "angle",
        "angles",
        "yaw",
        "pitch",
        "roll",
        "heading",
        "theta",
        "phi",
        "psi",
        "lin",
        "ang",
        "linear_velocity",
        "angular_velocity",
        "time",
        "utime",
        "timestamp",
        "secs",
        "nsecs",
        "nanosec",
        "nanosecs",
        "seconds",
        "nanoseconds",
        "frame",
        "frame_name",
        "child_frame",
        "title",
        "label",
        "key",
        "id",
        "index",
        "status",
        "state",
        "mode",
        "flag",
        "flags",
        "cov",
        "covariances",
        "pixels",
        "image",
        "buffer",
        "bytes",
        "ranges",
        "points",
        "priority",
        "valid",
        "enabled",
        "source",
        "sequence",
        "quality",
        "confidence",
        "version",
        "duration",
        "temperature",
        "battery",
    ]
)
_USUAL_LAST = tuple(
    (name, primitive)
    for name in ("id", "name", "status", "timestamp", "utime")
    for primitive in ("int32", "int64", "float64", "string")
)


def kinship(number: int, expected: Iterable[str] = ()) -> str:
    """How a type of this fingerprint differs from a known one; "" where that is not found.

    "like nav_msgs/Odometry, but without the field child_frame_id"

    Args:
        number: The fingerprint.
        expected: Names of types that it should be: these are compared first, and more closely.
    """
    names = list(dict.fromkeys(expected))
    for changes in (_changed, _moved, _retyped, _within, _renamed, _added):
        for name in names:
            for other, text in changes(message_class(name)):
                if other == number:
                    return f"like {name}, but {text}"
    return _table().get(number, "")


def fingerprint_of(parts: Iterable[Field]) -> int:
    """The fingerprint of a type that has these fields."""
    every = tuple(parts)
    return _finished(_hashed(_START, every), every)


@cache
def _table() -> dict[int, str]:
    """Every known type with one field changed, by fingerprint; it takes half a second to make."""
    found: dict[int, str] = {}
    for name in type_names():
        for number, text in _changed(message_class(name)):
            found.setdefault(number, f"like {name}, but {text}")
    return found


def _changed(cls: type[Message]) -> Iterator[tuple[int, str]]:
    own, before = fields(cls), _START
    for index, part in enumerate(own):
        after = own[index + 1 :]
        for middle, text in _alternatives(part, after[:1]):
            rest = after[1:] if len(middle) > 1 else after
            hashed = _hashed(_hashed(before, middle), rest)
            yield _finished(hashed, (*own[:index], *middle, *rest)), text
        before = _hashed(before, (part,))
    for name, primitive in _USUAL_FIRST:
        yield fingerprint_of((_new(name, primitive), *own)), f"with {name} ({primitive}) before"
    for name, primitive in _USUAL_LAST:
        hashed = _hashed(before, (_new(name, primitive),))
        yield _finished(hashed, own), f"with {name} ({primitive}) at the end"


def _moved(cls: type[Message]) -> Iterator[tuple[int, str]]:
    """The type with its fields in another order: any one where they are few."""
    own = fields(cls)
    orders = permutations(own) if len(own) <= _FEW else _one_moved(own)
    for order in orders:
        names = ", ".join(part.name for part in order)
        yield fingerprint_of(order), f"its fields stand in the order {names}"


def _one_moved(own: tuple[Field, ...]) -> Iterator[tuple[Field, ...]]:
    for index, part in enumerate(own):
        others = (*own[:index], *own[index + 1 :])
        for place in range(len(own)):
            yield (*others[:place], part, *others[place:])


def _retyped(cls: type[Message]) -> Iterator[tuple[int, str]]:
    """The type with all numbers of one kind of another, as float for double."""
    own = fields(cls)
    for kind in dict.fromkeys(part.type for part in own if part.message_class is None):
        for primitive in PRIMITIVES.values():
            parts = [replace(p, type=primitive) if p.type == kind else p for p in own]
            if primitive != kind:
                yield fingerprint_of(parts), f"every {kind} is {primitive}"


def _within(cls: type[Message]) -> Iterator[tuple[int, str]]:
    """The type with something changed in one that it contains, however deep."""
    own = fields(cls)
    hashed = _hashed(_START, own)
    inner = Counter(part.message_class for part in own if part.message_class)
    for part, times in inner.items():
        rest = sum(fingerprint(other) * n for other, n in inner.items() if other is not part)
        for number, text in chain(*(find(part) for find in (_changed, _moved, _retyped, _within))):
            where = "" if text.startswith("in ") else f"in {type_name(part)} "
            yield _rotated(hashed + rest + times * number), f"{where}{text}"


def _added(cls: type[Message]) -> Iterator[tuple[int, str]]:
    """The type with one field more at its end, under a name that fields have."""
    own = fields(cls)
    hashed = _hashed(_START, own)
    for name in _field_names():
        for primitive in PRIMITIVES.values():
            part = _new(name, primitive)
            yield _finished(_hashed(hashed, (part,)), own), f"with {name} ({primitive}) at the end"


def _renamed(cls: type[Message]) -> Iterator[tuple[int, str]]:
    """The type with one of its fields under another name that fields have."""
    own, before = fields(cls), _START
    for index, part in enumerate(own):
        for name in _field_names() | _variants(part.name):
            other = replace(part, name=name)
            hashed = _hashed(before, (other, *own[index + 1 :]))
            yield _finished(hashed, own), f"{part.name} is called {name}"
        before = _hashed(before, (part,))


@cache
def _field_names() -> frozenset[str]:
    """What fields are called, in all known types and elsewhere."""
    known = {part.name for name in type_names() for part in fields(message_class(name))}
    return frozenset(known | _USUAL_NAMES)


def _variants(name: str) -> set[str]:
    """A name as others would write it."""
    head, *tail = name.split("_")
    camel = head + "".join(word.capitalize() for word in tail)
    short = {name[:length] for length in range(1, len(name))}
    ends = {f"{name}{end}" for end in ("s", "_", "_m", "_rad", "_x", "1", "2", "_new", "_old")}
    return {camel, name.upper(), name.capitalize(), f"_{name}", f"m_{name}"} | short | ends


def _alternatives(
    part: Field, following: tuple[Field, ...]
) -> Iterator[tuple[tuple[Field, ...], str]]:
    """What may stand in place of a field, or of it and the one that follows."""
    yield (), f"without the field {part.name}"
    if part.message_class is None:
        for primitive in PRIMITIVES.values():
            if primitive != part.type:
                other = Field(part.name, primitive, None, part.dimensions, part.is_length)
                yield (other,), f"{part.name} is {primitive}, not {part.type}"
    for one in following:
        yield (one, part), f"{part.name} and {one.name} stand the other way round"


def _new(name: str, primitive: str) -> Field:
    return Field(name, primitive, None, (), is_length=False)


def _finished(value: int, parts: Iterable[Field]) -> int:
    nested = sum(fingerprint(part.message_class) for part in parts if part.message_class)
    return _rotated(value + nested)


def _rotated(total: int) -> int:
    total &= _MASK
    return ((total << 1) & _MASK) + (total >> 63)


def _hashed(value: int, parts: Iterable[Field]) -> int:
    for part in parts:
        for character in _characters(part):
            # the high bits come down as those of a signed number do
            high = value >> 55
            signed = high if value < _SIGN else high | ~0x1FF
            value = (((value << 8) ^ signed) + character) & _MASK
    return value


@cache
def _characters(part: Field) -> tuple[int, ...]:
    """What lcm-gen puts into the hash for a field."""
    found = _string(part.name)
    if part.message_class is None:
        found += _string(_LCM_NAMES[part.type])
    found += (len(part.dimensions),)
    for size in part.dimensions:
        found += (0 if isinstance(size, int) else 1, *_string(str(size)))
    return found


def _string(text: str) -> tuple[int, ...]:
    data = text.encode()
    return len(data), *(byte - 256 if byte > 127 else byte for byte in data)  # noqa: PLR2004 - char
