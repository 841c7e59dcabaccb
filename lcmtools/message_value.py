"""The base of all message classes: messages are values, like other values of Python.

Belongs here: ``==``, ``repr``, copies and pickles, for any class that has the tables of lcm-gen.
Keyword arguments are written by ``packages.python_code``. ``lcmtools.types`` imports this module,
so it must stay small, and it must not know the wire format or which types exist.
"""

import re
from collections.abc import Sequence
from contextlib import suppress
from functools import cache
from importlib import import_module
from reprlib import recursive_repr
from types import ModuleType
from typing import TYPE_CHECKING, BinaryIO, ClassVar, NamedTuple, Protocol, TypeGuard

_MOST_ELEMENTS = 8
_MOST_BYTES = 32
_MOST_CHARACTERS = 200
"""The lengths from which arrays, bytes and strings are cut in a ``repr``."""
_NO_ATTRIBUTE = re.compile(r"'(\w+)' object has no attribute '(\w+)'")


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

    def __init_subclass__(cls) -> None:
        """Let lcm-gen's encoder write arrays whole: by itself it believes the length fields."""
        if encode_one := vars(cls).get("_encode_one"):

            def encode_settled(self: Struct, buffer: BinaryIO) -> None:
                settle_lengths(self)
                encode_one(self, buffer)

            cls._encode_one = encode_settled  # type: ignore[attr-defined] # lcm-gen's

    if not TYPE_CHECKING:  # a type checker knows the fields

        def __getattr__(self, name: str) -> object:
            """Raise the error for a field that the message does not have."""
            raise NoField(self, name)

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


class NoField(AttributeError):  # noqa: N818 - named for what it says
    """An error that names a message's fields; its text is made only if it is shown."""

    def __init__(self, message: object, name: str) -> None:
        super().__init__(name, obj=message)  # without ``name=``, for which Python adds a hint

    def __str__(self) -> str:
        """Return the fields, and the one that was probably meant."""
        return _no_field(self.obj, self.args[0])


NoField.__module__, NoField.__qualname__, NoField.__name__ = "builtins", *["AttributeError"] * 2


class _Field(NamedTuple):
    name: str
    sizes: Sequence[int | str]  # of an array; none for a single value
    zeros: bytes  # the value of an empty row of bytes, if its size is fixed


def is_message(value: object) -> TypeGuard[Struct]:
    """Return True for a message of a class made by lcm-gen."""
    return hasattr(type(value), "__typenames__")


def settle_lengths(message: Struct) -> None:
    """Set a message's length fields from its arrays, and new arrays of bytes to zeros.

    ValueMismatch is raised for an array of another size than its type fixes, and for arrays and
    rows that share a length and differ.
    """
    lengths: dict[int | str, tuple[int, str]] = {}
    for field in _fields(type(message)):
        value = _value(message, field)
        if field.zeros:
            setattr(message, field.name, value)
        for depth, size in enumerate(field.sizes):
            for count in _counts(value, depth):
                _check_size(field.name, size, count, lengths.setdefault(size, (count, field.name)))
    for name, (count, _) in lengths.items():
        if isinstance(name, str):
            setattr(message, name, count)


def _check_size(name: str, size: int | str, count: int, first: tuple[int, str]) -> None:
    from lcmtools.errors import ValueMismatch  # late: only for this

    if isinstance(size, int) and count != size:
        raise ValueMismatch(f"{name}: expected {size} elements, got {count}")
    if count != first[0]:
        what = f"has {count} elements where {first[1]} has {first[0]}; they must be equal"
        if first[1] == name:
            what = f"its rows differ in length: {first[0]} and {count}"
        raise ValueMismatch(f"{name}: {what}")


def name_fields(error: BaseException) -> None:
    """Let Python's error for setting a field that a message does not have name the fields."""
    match = _NO_ATTRIBUTE.match(str(error)) if type(error) is AttributeError else None
    bases: tuple[type[MessageValue], ...] = (MessageValue, *MessageValue.__subclasses__())
    known = {cls.__name__: cls for base in bases for cls in base.__subclasses__()}
    if match and is_message(message := known.get(match[1], MessageValue)()):
        error.args = (_no_field(message, match[2]),)


def _no_field(message: object, name: str) -> str:
    from lcmtools.names import closest

    cls: type[Struct] = type(message)  # type: ignore[assignment] # a message's
    known = [field.name for field in _fields(cls)]
    values = {one: getattr(message, one, None) for one in known}
    inner = [f"{one}.{name}" for one, value in values.items() if name in _slots(value)]
    near = closest(name, known) or inner
    hint = f"; did you mean '{near[0]}'?" if near else ""
    fields = f"fields: {', '.join(known)}" if known else "it has no fields"
    return f"{cls.__name__} has no field '{name}' ({fields}){hint}"


def _slots(value: object) -> Sequence[str]:
    return type(value).__slots__ if is_message(value) else ()


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
    size = sizes[-1] if kind == "byte" and sizes else 0
    return bytes(size) if isinstance(size, int) else b""


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
    return _with_zeros(value, field.zeros) if field.zeros else value


def _with_zeros(value: object, zeros: bytes) -> object:
    """Return an array of bytes; a row without any, as lcm-gen's classes begin, has zeros."""
    if isinstance(value, list):
        return [_with_zeros(row, zeros) for row in value]
    return value or zeros if isinstance(value, bytes) else value


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


def _counts(value: object, depth: int) -> list[int]:
    """Return the lengths of all rows at a depth; at 0, of the array itself."""
    if depth == 0:
        return [len(value)]  # type: ignore[arg-type] # TypeError if it is not an array
    return [count for row in value for count in _counts(row, depth - 1)]  # type: ignore[attr-defined] # likewise


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


class LazyPackage(ModuleType):
    """A package whose ``__all__`` are types, each in a module of its name, imported when needed.

    As in packages of lcm-gen, the name in the package is the type, and not its module.
    """

    def __getattr__(self, name: str) -> object:
        """Import a type."""
        if name not in self.__dict__.get("__all__", ()):
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        import_module(f"{self.__name__}.{name}")
        return self.__dict__[name]

    def __setattr__(self, name: str, value: object) -> None:
        """Set the type where Python sets the imported module."""
        is_module = isinstance(value, ModuleType) and name in self.__dict__.get("__all__", ())
        super().__setattr__(name, getattr(value, name) if is_module else value)

    def __dir__(self) -> list[str]:
        """Return all types, also those that are not imported yet."""
        return sorted({*self.__dict__, *self.__dict__.get("__all__", ())})
