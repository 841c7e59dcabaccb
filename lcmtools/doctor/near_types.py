"""The known type that is most similar to an unknown one, by its fingerprint.

A fingerprint is computed from the names and types of fields (lcm-proj/lcm, lcmgen/lcmgen.c). So it
can be computed for a known type with one edit, and compared. Pure.

Results for 40 random edits of each kind (a field dropped, retyped, or swapped with the next; all
floats narrowed; a field dropped in a nested type): if the type is expected on the channel, all
differences are found; else the type is found in 28, 34, 34, 11 and 0 cases. Renamed and added
fields are not searched: even with 500 common names, three in four are not found.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from itertools import chain, pairwise, permutations

from lcmtools.messages.fields import PRIMITIVES, Field, fields
from lcmtools.messages.python_names import base_hash
from lcmtools.messages.registry import Message, fingerprint, message_class, type_name, type_names

_BITS = (1 << 64) - 1
_LCM_NAMES = {ours: lcm for lcm, ours in PRIMITIVES.items()}
_FEW = 5  # fields at most, of which all orders are tried
_USUAL = {"seq": "int32", "id": "int32", "utime": "int64", "timestamp": "int64", "name": "string"}
"""Common fields, which are often added."""

Edit = tuple[int, str]  # the fingerprint of an edited type, and the difference


@dataclass(frozen=True, slots=True)
class NearType:
    """A known type ("nav_msgs/Odometry"), and the difference ("without the field twist")."""

    name: str
    difference: str


def nearest_type(number: int, expected: Iterable[str] = ()) -> NearType | None:
    """Return the type that is one edit away from a fingerprint; None if there is none.

    The expected types are compared first, and with more edits.
    """
    for name in dict.fromkeys(expected):
        cls = message_class(name)
        for found, difference in chain(_edits(cls), _wider_edits(cls)):
            if found == number:
                return NearType(name, difference)
    return _table().get(number)


@cache
def _table() -> dict[int, NearType]:
    """Return every known type with one edit, by fingerprint; takes half a second."""
    pairs = ((name, edit) for name in type_names() for edit in _edits(message_class(name)))
    return {number: NearType(name, difference) for name, (number, difference) in pairs}


def _edits(cls: type[Message]) -> Iterator[Edit]:
    """Yield a type without a field, with one retyped or swapped, or with a common one more."""
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
