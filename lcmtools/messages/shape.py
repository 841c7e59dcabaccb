"""Arrays: their sizes, and the path to the element that does not fit.

Belongs here: everything that does not depend on the kind of elements. Must not know the wire
format, or where the values come from (a message's attributes or a user's text).
"""

import contextlib
from collections.abc import Callable, Sequence
from functools import cache

from lcmtools.messages.fields import Field, fields, visible_fields
from lcmtools.messages.registry import Message
from lcmtools.messages.scalars import INTEGERS, Misfit, from_python, given

Element = Callable[[object], object]
"""A conversion of an array's element, which raises Misfit."""


def as_sequence(value: object) -> Sequence[object]:
    """Return the elements of a list, a tuple or anything with ``tolist`` (numpy, memoryview ...).

    TypeError is raised for anything else: text, a mapping, a single number, ...
    """
    if type(value) in (list, tuple):
        return value  # type: ignore[return-value] # checked above, faster than isinstance
    tolist = getattr(value, "tolist", None)
    elements = tolist() if tolist else value
    if isinstance(elements, (str, bytes, bytearray)) or not isinstance(elements, Sequence):
        raise TypeError(f"{type(value).__name__} is not a list")
    return elements


def as_bytes(value: object) -> bytes:
    """Return the bytes of a bytes-like object of 8-bit elements or a sequence of numbers 0..255.

    TypeError is raised for other objects, ValueError for other numbers.
    """
    if isinstance(value, (bytes, bytearray)):
        return bytes(value)
    with contextlib.suppress(TypeError):  # if it has no buffer
        view = memoryview(value)  # type: ignore[arg-type] # likewise
        if view.format in ("B", "c") and view.ndim == 1:
            return view.tobytes()
    return bytes(as_sequence(value))  # type: ignore[arg-type] # bytes() checks each element


def shaped(value: object, field: Field, element: Element, depth: int = 0) -> object:
    """Convert each element of an array; return lists, for uint8 with bytes as the innermost.

    Misfit is raised for wrong fixed sizes; sizes in length fields are left to ``check_lengths``. An
    empty array of bytes means zeros: lcm-gen's classes start with it.
    """
    size, is_last = field.dimensions[depth], depth == len(field.dimensions) - 1
    if is_last and field.is_bytes:
        return _shaped_bytes(value, field, size, element)
    elements = _elements(value, field)
    _check_count(len(elements), field, size)
    if is_last:
        return each(elements, element)
    return each(elements, lambda row: shaped(row, field, element, depth + 1))


def check_lengths(message: Message) -> None:
    """Check array sizes given by length fields, in a message with arrays as lists or bytes.

    Misfit: rows or arrays that share a length field differ in length, or it is out of range.
    """
    cls = type(message)
    found: dict[str, tuple[int, str]] = {}
    for field in visible_fields(cls):
        for depth, size in enumerate(field.dimensions):
            if isinstance(size, str):
                for count in _counts(getattr(message, field.attribute), depth):
                    first, owner = found.setdefault(size, (count, field.name))
                    if count != first:
                        raise _disagreement(field.name, count, owner, first)
    for field in fields(cls):
        if field.name in found:
            _check_room(field, *found[field.name])


def check_given_length(message: Message, length: Field) -> None:
    """Raise Misfit for a length field with another value than the length of its arrays."""
    given_length = getattr(message, length.attribute)
    if given_length < 0:
        raise Misfit("is a length, which is never negative").inside(f".{length.name}")
    for array, depth in _sized_by(type(message), length.name):
        for count in _counts(getattr(message, array.attribute), depth):
            if count != given_length:
                of = "a row of " if depth else ""
                what = f"is {given_length}, and the length of {of}{array.name} is {count}"
                raise Misfit(what, "leave it out").inside(f".{length.name}")


def lone_lengths(message: Message) -> tuple[Field, ...]:
    """Return the length fields that the arrays of a message do not show: "cols" without rows."""
    return tuple(
        field
        for field in inner_lengths(type(message))
        if getattr(message, field.attribute)
        and not any(
            _counts(getattr(message, array.attribute), depth)
            for array, depth in _sized_by(type(message), field.name)
        )
    )


@cache
def inner_lengths(cls: type[Message]) -> tuple[Field, ...]:
    """Return the length fields of a class that are not the length of a whole array."""
    return tuple(
        field
        for field in fields(cls)
        if field.is_length and all(depth for _, depth in _sized_by(cls, field.name))
    )


def each(elements: Sequence[object], convert: Element) -> list[object]:
    """Convert every element; an error gets the element's index in its path."""
    result: list[object] = []
    try:
        result.extend(convert(element) for element in elements)
    except Misfit as misfit:
        misfit.inside(f"[{len(result)}]")
        raise
    return result


def _shaped_bytes(value: object, field: Field, size: int | str, element: Element) -> bytes:
    try:
        data = as_bytes(value)
    except (TypeError, ValueError):
        data = bytes(each(_elements(value, field), element))  # type: ignore[arg-type] # Misfit
    if not data and isinstance(size, int):
        return bytes(size)
    _check_count(len(data), field, size)
    return data


def _elements(value: object, field: Field) -> Sequence[object]:
    try:
        return as_sequence(value)
    except TypeError:
        raise Misfit(f"expected a list of {_plural(field)}, got {given(value)}") from None


def _check_count(count: int, field: Field, size: int | str) -> None:
    if isinstance(size, int) and count != size:
        raise Misfit(f"expected {size} {_plural(field)}, got {count}")


def _plural(field: Field) -> str:
    if field.message_class:
        return "messages"
    return {"bool": "booleans", "string": "strings"}.get(field.type, "numbers")


def _sized_by(cls: type[Message], length: str) -> list[tuple[Field, int]]:
    """Return the arrays that a length field belongs to, and the dimensions."""
    return [
        (field, depth)
        for field in visible_fields(cls)
        for depth, size in enumerate(field.dimensions)
        if size == length
    ]


def _counts(value: object, depth: int) -> list[int]:
    """Return the lengths of all rows at a depth; at 0, of the array itself."""
    if depth == 0:
        return [len(value)]  # type: ignore[arg-type] # lists or bytes
    return [count for row in as_sequence(value) for count in _counts(row, depth - 1)]


def _disagreement(name: str, count: int, owner: str, first: int) -> Misfit:
    what = f"has {count} elements where {owner} has {first}; they must be equal"
    if name == owner:
        what = f"its rows differ in length: {first} and {count}"
    return Misfit(what).inside(f".{name}")


def _check_room(length: Field, count: int, owner: str) -> None:
    try:
        from_python(count, length.type)
    except Misfit:
        high = INTEGERS[length.type][1]
        what = f"has {count} elements; its length field, {length.type}, holds {high} at most"
        raise Misfit(what).inside(f".{owner}") from None
