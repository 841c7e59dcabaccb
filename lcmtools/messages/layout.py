"""The fields of a type in their order in a payload.

Belongs here: flattening nested messages. A nested message adds only its fields, so a type is a
sequence of fields that are not messages, or are arrays: its leaves. Must not know bytes or values.
"""

import struct
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from itertools import pairwise
from math import inf, prod
from typing import NamedTuple, cast

from lcmtools.messages.array_codec import FORMATS, STRING_BYTES
from lcmtools.messages.fields import Field, fields
from lcmtools.messages.registry import Message, fingerprint, type_name

_FINGERPRINT_BYTES = 8


class Part(NamedTuple):
    """A message in a layout: the whole one, or one nested in it."""

    cls: type[Message]
    owner: int = 0  # index in ``Layout.parts`` of the message that contains it
    name: str = ""  # name of its field there, in Python


class Leaf(NamedTuple):
    """A field that is not a message, or that is an array."""

    part: int  # index of its message in ``Layout.parts``
    field: Field
    where: str  # "geometry_msgs/Twist.linear.x", for errors

    @property
    def is_number(self) -> bool:
        """True for a single number or boolean."""
        return not self.field.dimensions and self.field.type != "string"


class Layout(NamedTuple):
    """The messages in a message, the outermost first, and their leaves in wire order."""

    parts: tuple[Part, ...]
    leaves: tuple[Leaf, ...]


@cache
def layout(cls: type[Message]) -> Layout:
    """Return the layout of a class."""
    parts = [Part(cls)]
    leaves = tuple(_leaves(parts, 0, type_name(cls)))
    return Layout(tuple(parts), leaves)


def _leaves(parts: list[Part], place: int, path: str) -> Iterator[Leaf]:
    """Yield the leaves of the part at an index; nested messages are added to the parts."""
    for part in fields(parts[place].cls):
        where = f"{path}.{part.name}"
        if part.message_class and not part.dimensions:
            parts.append(Part(part.message_class, place, part.attribute))
            yield from _leaves(parts, len(parts) - 1, where)
        else:
            yield Leaf(place, part, where)


def is_generated(cls: type) -> bool:
    """Return True for a class made by lcm-gen."""
    return hasattr(cls, "__typenames__")


def has_wire_type(message: object, cls: type[Message]) -> bool:
    """Return True for an object with the fields of a ``cls``, in the same order.

    A geometry_msgs/Point may replace a Vector3, as with lcm-gen's own encoders.
    """
    kind = cast("type[Message]", type(message))
    return kind is cls or (is_generated(kind) and fingerprint(kind) == fingerprint(cls))


def check_type(value: object, cls: type[Message]) -> None:
    """Raise TypeError for an object that does not have the fields of a ``cls``."""
    if not has_wire_type(value, cls):
        raise TypeError(f"not a {cls.__name__}")


@cache
def stamp_reader(cls: type[Message]) -> Callable[[bytes], Sequence[int]] | None:
    """Return a function that reads header.stamp from a payload; None without a fixed place."""
    before, stamp = _FINGERPRINT_BYTES, f"{type_name(cls)}.header.stamp"
    for leaf, after in pairwise(layout(cls).leaves):
        if not (leaf.is_number and after.is_number):
            break
        if (leaf.where, after.where) == (f"{stamp}.sec", f"{stamp}.nsec"):
            is_usual = leaf.field.type == after.field.type == "int32"
            return struct.Struct(f">{before}x2i").unpack_from if is_usual else None
        before += _smallest(leaf.field)
    return None


@cache
def smallest(cls: type[Message]) -> int:
    """Return the smallest size of a message [byte], with all arrays of variable size empty."""
    return sum(_smallest(leaf.field) for leaf in layout(cls).leaves)


def _smallest(field: Field) -> int:
    count = prod(size if isinstance(size, int) else 0 for size in field.dimensions)
    if not count:  # checked first: a type may contain an array of itself
        return 0
    if field.message_class:
        return count * smallest(field.message_class)
    code = FORMATS.get(field.type)
    return count * (struct.calcsize(f">{code}") if code else STRING_BYTES)


@cache
def longest_array(cls: type[Message]) -> float:
    """Return the most elements that an array of a type can have; inf if it has a length field."""
    sizes: list[float] = [0]
    for leaf in layout(cls).leaves:
        sizes += [size if isinstance(size, int) else inf for size in leaf.field.dimensions]
        if leaf.field.message_class and inf not in sizes:
            sizes.append(longest_array(leaf.field.message_class))
    return max(sizes)


@cache
def has_byte_array(cls: type[Message]) -> bool:
    """Return True if a type has bytes of variable size, as images, point clouds and grids do."""
    return any(
        leaf.field.type in ("uint8", "int8")
        and not all(isinstance(size, int) for size in leaf.field.dimensions)
        for leaf in layout(cls).leaves
    )


def is_bounded(cls: type[Message]) -> bool:
    """Return True if the size of a payload bounds the content of a message of a type.

    It does if each message in it takes bytes, without arrays of several dimensions or of itself.
    """
    return _is_bounded(cls, frozenset())


@cache
def _is_bounded(cls: type[Message], above: frozenset[type[Message]]) -> bool:
    inner = above | {cls}
    return (
        cls not in above
        and smallest(cls) > 0
        and all(
            len(leaf.field.dimensions) < 2  # noqa: PLR2004 - one dimension
            and (not leaf.field.message_class or _is_bounded(leaf.field.message_class, inner))
            for leaf in layout(cls).leaves
        )
    )
