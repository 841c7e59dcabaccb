"""Messages in which only some numbers change, encoded beforehand for high rates.

Belongs here: the place of a field in a payload. Must not know channels or datagrams.
"""

import struct
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import prod
from typing import cast

from lcmtools.errors import ValueMismatch
from lcmtools.messages.array_codec import FORMATS
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.fields import Field, fields, length_values
from lcmtools.messages.registry import Message, type_name
from lcmtools.messages.scalars import STRAY_BYTES

_FINGERPRINT_BYTES = 8
_STRING_BYTES = 5  # bytes of a string's length and its closing NUL


class PayloadTemplate:
    """The payload of a message with holes, which can be filled with numbers repeatedly.

    Faster than creating a message and encoding it, as bench/codec.py shows:

        odometry = PayloadTemplate(message, "header.stamp", "pose.pose.position", "twist.twist")
        payload = odometry.fill((3, 500_000_000), (1.0, 2.0, 0.0), (0.5, 0.0, 0.0, 0.0, 0.0, 0.3))

    Args:
        message: The values of all other fields; it is not kept.
        holes: Paths of fields that are numbers, or contain only numbers ("header.stamp", "ranges",
            "transforms[0].transform"). An array keeps its size in the message. They may come in any
            order, and must not overlap.

    Attributes:
        payload: The payload of the message as given.
        holes: For each hole, in the given order, its offset in the payload and its numbers'
            ``struct`` codes ("2i", "1d1d1d").

    Raises:
        ValueMismatch: The message cannot be encoded, or a hole is not such a field.
    """

    def __init__(self, message: Message, *holes: str) -> None:
        cls, payload = type(message), encode(message)
        leaves = list(_leaves(decode(cls, payload, keep_stray=True), "", _FINGERPRINT_BYTES))
        found = sorted((_hole(leaves, path, type_name(cls)), at) for at, path in enumerate(holes))
        self._parts: list[bytes] = []
        self._packers = [struct.Struct("")] * len(holes)
        self._places = [0] * len(holes)
        end = 0
        for number, ((start, codes), at) in enumerate(found):
            if start < end:
                raise ValueMismatch(f"{type_name(cls)}: the hole {holes[at]} is in another one")
            self._parts += (payload[end:start], b"")
            self._packers[at] = struct.Struct(f">{codes}")
            self._places[at] = 2 * number + 1
            end = start + self._packers[at].size
        self._parts.append(payload[end:])
        self.payload = payload
        self.holes = tuple(hole for hole, _ in sorted(found, key=lambda one: one[1]))

    def fill(self, *rows: Iterable[float]) -> bytes:
        """Return the payload with these numbers in the holes: a row for each hole, in order.

        Raises:
            struct.error: A row has too many or too few numbers, or one has the wrong type.
            ValueError: There are not as many rows as holes.
        """
        parts = self._parts.copy()
        for place, packer, row in zip(self._places, self._packers, rows, strict=True):
            parts[place] = packer.pack(*row)
        return b"".join(parts)

    def fill_packed(self, rows: Iterable[bytes]) -> bytes:
        """Return the payload with rows that are already packed, in big-endian order.

        Raises:
            ValueError: There are not as many rows as holes.
        """
        parts = self._parts.copy()
        for place, row in zip(self._places, rows, strict=True):
            parts[place] = row
        return b"".join(parts)


@dataclass(frozen=True, slots=True)
class _Leaf:
    """A field that is not a message: its bytes in the payload, and their ``struct`` codes.

    The codes are "" for a value that is not a number.
    """

    path: str
    start: int
    size: int
    codes: str


def _leaves(message: Message, path: str, start: int) -> Iterator[_Leaf]:
    """Yield the fields of a decoded message, in their order in the payload."""
    for part in fields(type(message)):
        depth = 0 if part.type in FORMATS else len(part.dimensions)
        for where, value in _elements(getattr(message, part.attribute), depth, path + part.name):
            if part.message_class:
                inner = list(_leaves(cast("Message", value), f"{where}.", start))
            else:
                inner = [_leaf(message, part, value, where, start)]
            yield from inner
            start += sum(leaf.size for leaf in inner)


def _elements(value: object, depth: int, path: str) -> Iterator[tuple[str, object]]:
    if not depth:
        yield path, value
        return
    for index, element in enumerate(cast("Sequence[object]", value)):
        yield from _elements(element, depth - 1, f"{path}[{index}]")


def _leaf(message: Message, part: Field, value: object, path: str, start: int) -> _Leaf:
    if isinstance(value, str):
        return _Leaf(path, start, len(value.encode("utf-8", STRAY_BYTES)) + _STRING_BYTES, "")
    codes = f"{prod(length_values(message, part))}{FORMATS[part.type]}"
    return _Leaf(path, start, struct.calcsize(f">{codes}"), "" if part.is_length else codes)


def _hole(leaves: Iterable[_Leaf], path: str, name: str) -> tuple[int, str]:
    """Return a hole's offset in the payload, and the ``struct`` codes of its numbers."""
    inside = [leaf for leaf in leaves if _is_in(leaf.path, path)]
    if not inside:
        raise ValueMismatch(f"{name} has no field {path}")
    for leaf in inside:
        if not leaf.codes:
            raise ValueMismatch(f"{name}: {leaf.path} can change its size: it is no hole")
    return inside[0].start, "".join(leaf.codes for leaf in inside)


def _is_in(leaf: str, path: str) -> bool:
    return leaf == path or leaf.startswith((f"{path}.", f"{path}["))
