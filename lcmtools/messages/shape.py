"""Arrays: their sizes, and the path to the element that does not fit.

Belongs here: what holds for an array whatever its elements are. Must not know the wire format,
nor where the values come from (a message's attributes or a user's text).
"""

import contextlib
from collections.abc import Callable, Iterator, Sequence

from lcmtools.messages.fields import Field, fields, visible_fields
from lcmtools.messages.misfit import Misfit, given
from lcmtools.messages.registry import Message
from lcmtools.messages.scalars import INTEGERS, from_python

Element = Callable[[object], object]


def as_sequence(value: object) -> Sequence[object]:
    """The elements of a list, a tuple or anything with ``tolist`` (numpy, array, memoryview).

    Raises:
        TypeError: It is nothing of the kind: text, a mapping, a single number, ...
    """
    if type(value) in (list, tuple):
        return value  # type: ignore[return-value] # checked above, faster than isinstance
    tolist = getattr(value, "tolist", None)
    elements = tolist() if tolist else value
    if isinstance(elements, (str, bytes, bytearray)) or not isinstance(elements, Sequence):
        raise TypeError(f"{type(value).__name__} is not a list")
    return elements


def as_bytes(value: object) -> bytes:
    """The bytes of a bytes-like object of 8-bit elements, or of a sequence of numbers 0..255.

    Raises:
        TypeError: It is nothing of the kind.
        ValueError: A number is not a byte.
    """
    if isinstance(value, (bytes, bytearray)):
        return bytes(value)
    with contextlib.suppress(TypeError):  # when it has no buffer
        view = memoryview(value)  # type: ignore[arg-type] # likewise
        if view.format in ("B", "c") and view.ndim == 1:
            return view.tobytes()
    return bytes(as_sequence(value))  # type: ignore[arg-type] # bytes() checks each element


def shaped(value: object, field: Field, element: Element) -> object:
    """An array's value as lists, innermost bytes for uint8, with each element converted.

    Sizes that are numbers are checked; sizes in length fields are for ``lengths`` to check. An
    empty array of bytes stands for one of zeros, because lcm-gen's classes start with it.

    Raises:
        Misfit: A size differs or an element does not fit.
    """
    return _shaped(value, field, 0, element)


def lengths(message: Message) -> dict[str, int]:
    """The value that every length field of a message must have; its arrays are lists or bytes.

    A length that no array tells (the inner one of an array without rows) is left out.

    Raises:
        Misfit: Rows or arrays that share a length field differ in length, or it cannot hold it.
    """
    cls = type(message)
    found: dict[str, tuple[int, str]] = {}
    for field in visible_fields(cls):
        for depth, size in enumerate(field.dimensions):
            for count in _counts(getattr(message, field.name), depth) if _is_name(size) else ():
                first, owner = found.setdefault(str(size), (count, field.name))
                if count != first:
                    raise _disagreement(field.name, count, owner, first)
    for field in fields(cls):
        if field.name in found:
            _check_room(field, *found[field.name])
    return {name: count for name, (count, _) in found.items()}


def plural(field: Field) -> str:
    """The name of several elements of a field in an error."""
    if field.message_class:
        return "messages"
    return {"bool": "booleans", "string": "strings"}.get(field.type, "numbers")


def _shaped(value: object, field: Field, depth: int, element: Element) -> object:
    size, last = field.dimensions[depth], depth == len(field.dimensions) - 1
    if last and field.is_bytes:
        return _shaped_bytes(value, field, size, element)
    elements = _elements(value, field)
    _check_count(len(elements), field, size)
    if last:
        return each(elements, element)
    return each(elements, lambda row: _shaped(row, field, depth + 1, element))


def _shaped_bytes(value: object, field: Field, size: int | str, element: Element) -> bytes:
    try:
        data = as_bytes(value)
    except (TypeError, ValueError):
        data = bytes(each(_elements(value, field), element))  # type: ignore[arg-type] # Misfit
    if not data and isinstance(size, int):
        return bytes(size)
    _check_count(len(data), field, size)
    return data


def each(elements: Sequence[object], convert: Element) -> list[object]:
    """Every element converted; an error gets the element's index into its path."""
    result: list[object] = []
    try:
        result.extend(convert(element) for element in elements)
    except Misfit as misfit:
        misfit.inside(f"[{len(result)}]")
        raise
    return result


def _elements(value: object, field: Field) -> Sequence[object]:
    try:
        return as_sequence(value)
    except TypeError:
        raise Misfit(f"expected a list of {plural(field)}, got {given(value)}") from None


def _check_count(count: int, field: Field, size: int | str) -> None:
    if isinstance(size, int) and count != size:
        raise Misfit(f"expected {size} {plural(field)}, got {count}")


def _counts(value: object, depth: int) -> Iterator[int]:
    """The lengths of all rows at a depth: of the array itself at 0."""
    rows = as_sequence(value) if depth else ()
    if depth == 0:
        yield len(value)  # type: ignore[arg-type] # lists or bytes, as ``lengths`` asks for
    for row in rows:
        yield from _counts(row, depth - 1)


def _is_name(size: int | str) -> bool:
    return isinstance(size, str)


def _disagreement(name: str, count: int, owner: str, first: int) -> Misfit:
    if name == owner:
        misfit = Misfit(f"its rows differ in length: {first} and {count}")
    else:
        misfit = Misfit(f"has {count} elements where {owner} has {first}; they must be equal")
    misfit.inside(f".{name}")
    return misfit


def _check_room(length: Field, count: int, owner: str) -> None:
    try:
        from_python(count, length.type)
    except Misfit:
        high = INTEGERS[length.type][1]
        misfit = Misfit(
            f"has {count} elements; its length field, {length.type}, holds {high} at most"
        )
        misfit.inside(f".{owner}")
        raise misfit from None
