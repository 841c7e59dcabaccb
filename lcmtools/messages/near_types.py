"""The known type that is most similar to an unknown one, by its fingerprint.

A fingerprint is computed from the names and types of fields (lcm-proj/lcm, lcmgen/lcmgen.c). So it
can be computed for a known type with one edit, and compared. Pure.

Results for 40 random edits of each kind (a field dropped, retyped, or swapped with the next; all
floats narrowed; a field dropped in a nested type): if the type is expected on the channel, all
differences are found; else the type is found in 28, 34, 34, 11 and 0 cases. Renamed fields are not
searched, and added ones only at the end of an expected type, with names that other types have:
among all types, even with 500 common names, three in four are not found. Of many own types, only
some are compared where they are not expected.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from itertools import chain, islice, pairwise, permutations

from lcmtools.errors import LcmtoolsError
from lcmtools.messages.codec import NOT_PLAIN
from lcmtools.messages.coder import coder
from lcmtools.messages.fields import PRIMITIVES, Field, fields
from lcmtools.messages.plain import to_plain
from lcmtools.messages.python_names import base_hash
from lcmtools.messages.registry import (
    Message,
    Registry,
    default_registry,
    fingerprint,
    is_own,
    message_class,
    type_name,
    versioned,
)
from lcmtools.messages.type_names import preference, resemblance

_BITS = (1 << 64) - 1
_LCM_NAMES = {ours: lcm for lcm, ours in PRIMITIVES.items()}
_FEW = 5  # fields at most, of which all orders are tried
_USUAL = {"seq": "int32", "id": "int32", "utime": "int64", "timestamp": "int64", "name": "string"}
"""Common fields, which are often added."""

_MOST_OWN = 200  # of the user's types are compared, besides expected ones: more take seconds
_ALIKE = 0.5  # share of the words in the names of a type and a channel
_LEAST, _MOST = 1e-12, 1e18  # sizes of numbers that are not 0
_FINGERPRINT_BYTES = 8
_MOST_ZEROS = 3  # bytes in the hash that a fingerprint is

Edit = tuple[int, str]  # the fingerprint of an edited type, and the difference


@dataclass(frozen=True, slots=True)
class NearType:
    """A known type ("nav_msgs/Odometry"), and the difference ("without the field twist")."""

    name: str
    difference: str


def nearest_type(number: int, expected: Iterable[str] = (), channel: str = "") -> NearType | None:
    """Return the type that is one edit away from a fingerprint; None if there is none.

    The expected types are compared first, and with more edits. Of several others, the likeliest for
    the channel is returned: see ``Registry.candidates``.
    """
    for name in dict.fromkeys(expected):
        with suppress(LcmtoolsError):  # its file is broken: other types are not affected
            cls = message_class(name)
            for found, difference in chain(_edits(cls), _wider_edits(cls), _appended(cls)):
                if found == number:
                    return NearType(_name(cls), difference)

    def order(one: NearType) -> tuple[object, ...]:
        short, whole = resemblance(one.name, channel)
        return -short, -whole, not is_own(one.name), *preference(one.name)

    edits = _table(default_registry()).get(number, ())
    near = (NearType(_name(cls), difference) for cls, difference in edits)
    return min(near, key=order, default=None)


def may_be_fingerprint(number: int) -> bool:
    """Return whether a number may be a hash: plain numbers have many zero bytes."""
    return (number & _BITS).to_bytes(8, "big").count(0) <= _MOST_ZEROS


def own_types_like(channel: str) -> list[str]:
    """Return the user's own types whose names resemble a channel's, the most similar first."""
    shares = {name: resemblance(name, channel)[0] for name in default_registry().files()}
    found = [name for name, share in shares.items() if share >= _ALIKE]
    return sorted(found, key=lambda name: (-shares[name], name))


def grown_type(payload: bytes, expected: Iterable[str]) -> str:
    """Return the type whose fields a payload has before other bytes; "" for none of the expected.

    So a type is recognized to which fields of unknown names were appended.
    """
    for name in dict.fromkeys(expected):
        with suppress(LcmtoolsError, *NOT_PLAIN):
            cls = message_class(name)
            message, end = coder(cls).scan(payload, _FINGERPRINT_BYTES)
            if cls.__slots__ and end < len(payload) and _is_plausible(to_plain(message)):
                return name
    return ""


def _is_plausible(value: object) -> bool:
    """Return whether values are such as programs send, not other bytes taken for them."""
    if isinstance(value, (dict, list)):
        return all(map(_is_plausible, value.values() if isinstance(value, dict) else value))
    if isinstance(value, float):
        return value == 0 or _LEAST < abs(value) < _MOST
    return value.isprintable() if isinstance(value, str) else True


def added_and_missing(one: type[Message], other: type[Message]) -> tuple[list[str], list[str]]:
    """Return the names of the fields that a type has in addition to another's, and lacks."""
    first, second = ({_identity(part): part.name for part in fields(cls)} for cls in (one, other))
    return (
        [name for key, name in first.items() if key not in second],
        [name for key, name in second.items() if key not in first],
    )


def _identity(part: Field) -> tuple[object, ...]:
    """Return all of a field that its type's fingerprint depends on."""
    kind = fingerprint(part.message_class) if part.message_class else part.type
    return part.name, kind, part.dimensions


def _name(cls: type[Message]) -> str:
    return versioned(type_name(cls), fingerprint(cls))


@lru_cache(maxsize=1)
def _table(registry: Registry) -> Mapping[int, Sequence[tuple[type[Message], str]]]:
    """Return the compared types with one edit, by fingerprint; takes half a second or more."""
    found = defaultdict(list)
    for cls in _compared_types(registry):
        for number, difference in _edits(cls):
            found[number].append((cls, difference))
    return found


@lru_cache(maxsize=1)
def _compared_types(registry: Registry) -> list[type[Message]]:
    """Return the types that are compared with any other: of many own ones, only the first."""
    names, own = registry.type_names(), registry.files()
    some = set(islice((name for name in names if name in own), _MOST_OWN))
    return list(registry.message_classes(n for n in names if n in some or n not in own))


@lru_cache(maxsize=1)
def _usual_fields(registry: Registry) -> frozenset[Field]:
    """Return every field of a known type that is a number, a text or an array of fixed size."""
    classes = _compared_types(registry)
    every = (part for cls in classes for part in fields(cls) if not part.is_length)
    return frozenset(
        part
        for part in every
        if part.message_class is None and not any(isinstance(n, str) for n in part.dimensions)
    )


def _appended(cls: type[Message]) -> Iterator[Edit]:
    """Yield a type with one more field at its end, as other types have them."""
    own = fields(cls)
    for part in _usual_fields(default_registry()):
        yield fingerprint_of((*own, part)), f"with {part.name} ({part.type}) at the end"


def _edits(cls: type[Message]) -> Iterator[Edit]:
    """Yield a type without a field or its last ones, with one retyped, swapped or added."""
    own = fields(cls)
    reversed_number = int.from_bytes(fingerprint(cls).to_bytes(8, "big"), "little")
    yield reversed_number, "its bytes are reversed: LCM sends the highest byte of a number first"
    for index, part in enumerate(own):
        before, after = own[:index], own[index + 1 :]
        yield fingerprint_of((*before, *after)), f"without the field {part.name}"
        for other in _retyped(part):
            text = f"{part.name} is {other.type}, not {part.type}"
            yield fingerprint_of((*before, other, *after)), text
    for index, (one, other) in enumerate(pairwise(own)):
        text = f"{one.name} and {other.name} exchanged"
        yield fingerprint_of((*own[:index], other, one, *own[index + 2 :])), text
    for count in range(max(2, len(own) // 2), len(own) - 1):
        names = ", ".join(part.name for part in own[count:])
        yield fingerprint_of(own[:count]), f"without the fields {names}"
    for name, primitive in _USUAL.items():
        part = Field(name, primitive, None, (), is_length=False)
        yield fingerprint_of((*own, part)), f"with {name} ({primitive}) at the end"
        yield fingerprint_of((part, *own)), f"with {name} ({primitive}) before"


def _wider_edits(cls: type[Message]) -> Iterator[Edit]:
    """Yield a type with reordered fields, a replaced kind of number, or an edited nested type."""
    own = fields(cls)
    for order in permutations(own) if len(own) <= _FEW else ():
        names = ", ".join(part.name for part in order)
        yield fingerprint_of(order), f"its fields in the order {names}"
    for kind in dict.fromkeys(part.type for part in own if part.message_class is None):
        for primitive in PRIMITIVES.values():
            parts = (p._replace(type=primitive) if p.type == kind else p for p in own)
            yield fingerprint_of(parts), f"every {kind} is {primitive}"
    for inner in dict.fromkeys(part.message_class for part in own if part.message_class):
        for number, text in chain(_edits(inner), _wider_edits(inner)):
            where = "" if text.startswith("in ") else f"in {type_name(inner)} "
            yield fingerprint_of(own, {inner: number}), f"{where}{text}"


def _retyped(part: Field) -> Iterator[Field]:
    if part.message_class is None:
        others = (primitive for primitive in PRIMITIVES.values() if primitive != part.type)
        yield from (part._replace(type=primitive) for primitive in others)


def fingerprint_of(parts: Iterable[Field], others: dict[type[Message], int] | None = None) -> int:
    """Return the fingerprint of a type with these fields.

    ``others`` replaces the fingerprints of nested types.
    """
    own = tuple(parts)
    total = base_hash((p.name, _LCM_NAMES.get(p.type, ""), p.dimensions) for p in own)
    for kind in (part.message_class for part in own if part.message_class):
        total += (others or {}).get(kind) or fingerprint(kind)
    total &= _BITS
    return ((total << 1) & _BITS) + (total >> 63)
