"""Conversions between integers of LCM, which are signed, and those of ROS.

A number keeps its bits, so that it comes back as it was; a larger type of LCM keeps its value.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple, TypeAlias

from lcmtools.errors import DecodeError
from lcmtools.messages.fields import Field

Conversions: TypeAlias = tuple[Callable[[Any], Any], Callable[[Any], Any]]  # to ROS, to LCM

_BITS = {
    **dict.fromkeys(("byte", "char", "octet", "int8", "uint8"), 8),
    **{f"{sign}int{bits}": bits for sign in ("", "u") for bits in (16, 32, 64)},
}
_SIGNED = ("int8", "int16", "int32", "int64")
_WIDENED = ("uint16", "uint32")


class Change(NamedTuple):
    """Numbers of a message that its LCM type cannot hold, so that they became negative."""

    field: str  # its path: "header.seq"
    numbers: int  # how many
    example: int  # the first of them, in ROS


def holds(ours: str, theirs: str) -> bool:
    """Return whether an LCM type has the bits of an integer of ROS, or is larger than unsigned."""
    if ours not in _BITS or theirs not in _BITS:
        return False
    is_larger = theirs in _WIDENED and _BITS[ours] == 2 * _BITS[theirs]
    return is_larger or _BITS[ours] == _BITS[theirs]


def number_conversions(part: Field, name: str, changes: list[Change]) -> Conversions:
    """Return the conversions of an integer whose type in ROS is ``name``; note changed numbers.

    A ``byte`` is signed, as in ROS 1; ROS 2 calls its unsigned one ``octet``.
    """
    ours, theirs = _bounds(part.type), _bounds(name)

    def to_ros(value: Any) -> int:  # noqa: ANN401 - a number of any type
        low, high = theirs
        if not low <= int(value) <= high and _BITS[part.type] > _BITS[name]:
            raise _too_large(part, int(value))
        return _same_bits(int(value), theirs)

    def to_lcm(value: Any) -> int:  # noqa: ANN401 - likewise
        there = _same_bits(int(value), theirs)  # the library reads each byte as signed
        found = _same_bits(there, ours)
        if found != there and name != "byte":
            changes.append(Change(part.name, 1, there))
        return found

    return to_ros, to_lcm


def array_conversions(part: Field, name: str, changes: list[Change]) -> Conversions:
    """Return the conversions of an array of numbers of any type; note changed numbers."""
    import numpy as np

    ours = np.dtype(part.type)
    theirs = np.dtype("uint8" if name in ("byte", "char", "octet") else name)
    is_larger = ours.itemsize > theirs.itemsize
    can_change = not is_larger and theirs.kind != ours.kind and name != "byte"

    def to_ros(values: Any) -> Any:  # noqa: ANN401 - any value in messages
        if part.depth > 1:
            values = list(flat(values, part.depth))
        elif isinstance(values, (bytes, bytearray)):
            return np.frombuffer(values, theirs)
        found = np.asarray(values, ours)
        if not is_larger:
            return found.view(theirs)
        narrow = found.astype(theirs)
        for value in found[narrow != found][:1]:
            raise _too_large(part, int(value))
        return narrow

    def to_lcm(values: Any) -> Any:  # noqa: ANN401 - likewise
        there = np.ascontiguousarray(values, theirs)
        found = there.astype(ours) if is_larger else there.view(ours)
        if can_change and (changed := there[(found if ours.kind == "i" else there) < 0]).size:
            changes.append(Change(part.name, changed.size, int(changed[0])))
        return found.tobytes() if part.is_bytes and part.depth == 1 else found.tolist()

    return to_ros, to_lcm


def flat(values: Sequence[Any], depth: int) -> Iterator[Any]:
    """Yield the elements of nested lists."""
    if depth == 1:
        yield from values
    else:
        for row in values:
            yield from flat(row, depth - 1)


def _bounds(name: str) -> tuple[int, int]:
    """Return the least and the greatest number of an integer type."""
    bits = _BITS[name]
    return (-(1 << bits - 1), (1 << bits - 1) - 1) if name in _SIGNED else (0, (1 << bits) - 1)


def _same_bits(value: int, bounds: tuple[int, int]) -> int:
    """Return the number of a type, from its least to its greatest number, with the same bits."""
    low, high = bounds
    return (value - low) % (high - low + 1) + low


def _too_large(part: Field, value: int) -> DecodeError:
    return DecodeError(f"{part.name} is {value}, which ROS's smaller type cannot hold")
