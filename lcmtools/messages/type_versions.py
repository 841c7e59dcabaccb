"""Versions of a type: the fields in which two differ, and another version by its fingerprint.

A fingerprint is computed from the names and types of fields (lcm-proj/lcm, lcmgen/lcmgen.c). So the
one of an expected type with an edit can be computed, and compared with an unknown one: a field
dropped, added, retyped, or exchanged with the next. Other unknown types stay unknown. Pure.
"""

from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise

from lcmtools.errors import LcmtoolsError
from lcmtools.messages.fields import PRIMITIVES, Field, fields
from lcmtools.messages.python_names import base_hash
from lcmtools.messages.registry import (
    Message,
    fingerprint,
    message_class,
    type_files,
    type_name,
    versioned,
)
from lcmtools.messages.type_names import resemblance

_BITS = (1 << 64) - 1
_LCM_NAMES = {ours: lcm for lcm, ours in PRIMITIVES.items()}
_USUAL = {"seq": "int32", "id": "int32", "utime": "int64", "timestamp": "int64", "name": "string"}
"""Common fields, which are often added."""
_ALIKE = 0.5  # share of the words in the names of a type and a channel

_MOST_ZEROS = 3  # bytes in the hash that a fingerprint is

Edit = tuple[int, str]  # the fingerprint of an edited type, and the difference


@dataclass(frozen=True, slots=True)
class Version:
    """A known type ("nav_msgs/Odometry"), and the difference ("without the field twist")."""

    name: str
    difference: str


def other_version(number: int, expected: Iterable[str]) -> Version | None:
    """Return the expected type that is one edit away from a fingerprint; None if there is none."""
    for name in dict.fromkeys(expected):
        with suppress(LcmtoolsError):  # its file is broken: other types are not affected
            cls = message_class(name)
            found = next((text for edited, text in _edits(cls) if edited == number), "")
            if found:
                return Version(versioned(type_name(cls), fingerprint(cls)), found)
    return None


def may_be_fingerprint(number: int) -> bool:
    """Return whether a number may be a hash: plain numbers have many zero bytes."""
    return (number & _BITS).to_bytes(8, "big").count(0) <= _MOST_ZEROS


def own_types_like(channel: str, own: Iterable[str] | None = None) -> list[str]:
    """Return the user's ``own`` types whose names resemble a channel's, the most similar first."""
    names = type_files() if own is None else own
    shares = {name: resemblance(name, channel)[0] for name in names}
    found = [name for name, share in shares.items() if share >= _ALIKE]
    return sorted(found, key=lambda name: (-shares[name], name))


def added_and_missing(one: type[Message], other: type[Message]) -> tuple[list[str], list[str]]:
    """Return the fields that a type has in addition to another's, and lacks, with nested ones.

    A field that both have with different types is in both; so are all if only their order differs.
    """
    first, second = ({_identity(p): p for p in fields(cls)} for cls in (one, other))
    added = [part for key, part in first.items() if key not in second]
    missing = [part for key, part in second.items() if key not in first]
    if not (added or missing) and list(first) != list(second):
        pairs = zip(first.values(), second.values(), strict=True)
        moved = [part.name for part, was in pairs if part != was]
        return moved, moved
    nested = {p.name: p for p in missing}
    found: tuple[list[str], list[str]] = ([], [])
    for part in added:
        was = nested.get(part.name)
        if was and _same_struct(part, was) and part.message_class and was.message_class:
            inner = added_and_missing(part.message_class, was.message_class)
            for names, more in zip(found, inner, strict=True):
                names += [f"{part.name}.{name}" for name in more]
            del nested[part.name]
        else:
            found[0].append(part.name)
    found[1].extend(nested)
    return found


def _same_struct(part: Field, was: Field) -> bool:
    """Return whether a field has two versions of one type."""
    if part.message_class is None or was.message_class is None:
        return False
    one, other = map(type_name, (part.message_class, was.message_class))
    return one.rpartition("/")[2] == other.rpartition("/")[2] and part.dimensions == was.dimensions


def _identity(part: Field) -> tuple[object, ...]:
    """Return all of a field that its type's fingerprint depends on."""
    kind = fingerprint(part.message_class) if part.message_class else part.type
    return part.name, kind, part.dimensions


def _edits(cls: type[Message]) -> Iterator[Edit]:
    """Yield a type without a field or its last ones, with one retyped, exchanged or added."""
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


def _retyped(part: Field) -> Iterator[Field]:
    if part.message_class is None:
        others = (primitive for primitive in PRIMITIVES.values() if primitive != part.type)
        yield from (part._replace(type=primitive) for primitive in others)


def fingerprint_of(parts: Iterable[Field]) -> int:
    """Return the fingerprint of a type with these fields."""
    own = tuple(parts)
    total = base_hash((p.name, _LCM_NAMES.get(p.type, ""), p.dimensions) for p in own)
    total += sum(fingerprint(part.message_class) for part in own if part.message_class)
    total &= _BITS
    return ((total << 1) & _BITS) + (total >> 63)
