"""The base of all message classes: messages are values, like other values of Python.

Belongs here: ``==``, ``repr``, copies and pickles, for any class that has the tables of lcm-gen.
Keyword arguments are written by ``packages.python_code``. ``lcmtools.types`` imports this module,
so it must stay small, and it must not know the wire format or which types exist.
"""

from collections.abc import Sequence
from contextlib import suppress
from functools import cache
from reprlib import recursive_repr
from typing import ClassVar, NamedTuple, Protocol, TypeGuard

_MOST_ELEMENTS = 8
_MOST_BYTES = 32
_MOST_CHARACTERS = 200
"""The lengths from which arrays, bytes and strings are cut in a ``repr``."""


class Struct(Protocol):
    """A message of a class made by lcm-gen, with or without this base."""

    __slots__: ClassVar[list[str]]
    __typenames__: ClassVar[list[str]]
    __dimensions__: ClassVar[list[list[int | str] | None]]

    @staticmethod
    def _get_packed_fingerprint() -> bytes: ...


class MessageValue:
    """The base of a message class.

    Length fields, which are set when a message is sent, count neither for ``==`` nor for ``repr``.
    """

    __slots__: ClassVar[Sequence[str]] = ()
    __hash__ = None  # type: ignore[assignment] # messages are mutable

    def __repr__(self) -> str:
        """Return the type and its fields; long arrays, bytes and strings are cut."""
        return _message_text(self)

    def __eq__(self, other: object) -> bool:
        """Return True for a message of the same type with equal fields.

        Arrays are equal if their elements are: a list, a tuple, bytes or a numpy array. A type is
        the same if its name and its fingerprint are.
        """
        if not (is_message(self) and is_message(other) and _have_same_type(self, other)):
            return NotImplemented
        return _have_equal_fields(self, other)

    def __reduce_ex__(self, protocol: object) -> str | tuple[object, ...]:
        """Return the class and the fields: the older protocols of pickle cannot store slots."""
        return super().__reduce_ex__(max(int(protocol), 2))  # type: ignore[call-overload] # an int


class _Field(NamedTuple):
    name: str
    sizes: Sequence[int | str]  # of an array; none for a single value
    zeros: bytes  # the value of an empty array of bytes, if its size is fixed


def is_message(value: object) -> TypeGuard[Struct]:
    """Return True for a message of a class made by lcm-gen."""
    return hasattr(type(value), "__typenames__")


@cache
def _fields(cls: type[Struct]) -> tuple[_Field, ...]:
    """Return the fields of a class without length fields."""
    lengths = {size for sizes in cls.__dimensions__ for size in sizes or ()}
    tables = zip(cls.__slots__, cls.__typenames__, cls.__dimensions__, strict=True)
    return tuple(
        _Field(name, sizes or (), _zeros(kind, sizes or ()))
        for name, kind, sizes in tables
        if name not in lengths
    )


def _zeros(kind: str, sizes: Sequence[int | str]) -> bytes:
    is_fixed = kind == "byte" and len(sizes) == 1 and isinstance(sizes[0], int)
    return bytes(sizes[0]) if is_fixed else b""  # type: ignore[arg-type] # a number


def _have_same_type(one: Struct, other: Struct) -> bool:
    cls, kind = type(one), type(other)
    if cls is kind:
        return True
    fingerprints = cls._get_packed_fingerprint(), kind._get_packed_fingerprint()  # noqa: SLF001 - lcm-gen's interface
    return cls.__name__ == kind.__name__ and fingerprints[0] == fingerprints[1]


def _have_equal_fields(one: Struct, other: Struct) -> bool:
    return all(
        _are_equal(_value(one, field), _value(other, field), len(field.sizes))
        for field in _fields(type(one))
    )


def _value(message: Struct, field: _Field) -> object:
    value: object = getattr(message, field.name, ...)
    is_new = field.zeros and isinstance(value, bytes) and not value  # as lcm-gen's classes begin
    return field.zeros if is_new else value


def _are_equal(one: object, other: object, depth: int) -> bool:
    """Compare two values with ``depth`` lists around each element."""
    if one is other:  # as for Python's lists, also for NaN
        return True
    if depth:
        return _are_equal_arrays(one, other, depth)
    if is_message(one) and is_message(other):
        return _have_same_type(one, other) and _have_equal_fields(one, other)
    return bool(one == other)


def _are_equal_arrays(one: object, other: object, depth: int) -> bool:
    with suppress(TypeError, ValueError, BufferError):  # not both arrays of numbers in memory
        return memoryview(one) == memoryview(other)  # type: ignore[arg-type] # likewise
    one, other = _elements(one), _elements(other)
    if one is None or other is None:
        return False
    pairs = zip(one, other, strict=False)
    return len(one) == len(other) and all(_are_equal(a, b, depth - 1) for a, b in pairs)


def _elements(value: object) -> Sequence[object] | None:
    """Return the elements of a list, a tuple, bytes or a numpy array; None for anything else."""
    tolist = getattr(value, "tolist", None)
    elements = tolist() if tolist else value
    return elements if isinstance(elements, (list, tuple, bytes, bytearray)) else None


@recursive_repr()
def _message_text(message: Struct) -> str:
    cls = type(message)
    fields = (f"{one.name}={_text(getattr(message, one.name, ...))}" for one in _fields(cls))
    return f"{cls.__name__}({', '.join(fields)})"


def _text(value: object) -> str:
    if is_message(value):
        return _message_text(value)
    if isinstance(value, str) and len(value) > _MOST_CHARACTERS:
        more = len(value) - _MOST_CHARACTERS
        return f"{value[:_MOST_CHARACTERS]!r}... {more} more"
    if isinstance(value, (bytes, bytearray)):
        return repr(value) if len(value) <= _MOST_BYTES else f"<{len(value)} bytes>"
    tolist = getattr(value, "tolist", None)
    if tolist and getattr(value, "shape", None) == ():  # a number of numpy
        return repr(tolist())
    return _array_text(value) if tolist or isinstance(value, (list, tuple)) else repr(value)


def _array_text(value: object) -> str:
    array: Sequence[object] = value  # type: ignore[assignment] # a list, or what has ``tolist``
    some, more = array[:_MOST_ELEMENTS], len(array) - _MOST_ELEMENTS
    tolist = getattr(some, "tolist", None)
    texts = [_text(one) for one in (tolist() if tolist else some)]
    return f"[{', '.join([*texts, f'... {more} more'] if more > 0 else texts)}]"
