"""Structs that may grow: LCM's encoding without a fingerprint; later versions append fields.

A reader ignores bytes after the fields that it knows, and leaves fields for which no bytes are left
at their defaults. DDS-XTypes calls such types appendable. Fields are never removed, changed or
inserted, and a nested struct that may grow is itself an array of bytes (lcmtools_msgs/Appendable).
"""

from collections.abc import Callable, Collection, Iterable
from typing import Any, Generic, TypeVar, cast

from lcmtools.errors import DecodeError
from lcmtools.messages.array_codec import Cursor, Malformed
from lcmtools.messages.codec import NOT_PLAIN, encode
from lcmtools.messages.coder import coder
from lcmtools.messages.registry import Message, type_name
from lcmtools.messages.scalars import STRAY_BYTES
from lcmtools.types.lcmtools_msgs import Appendable

M = TypeVar("M", bound=Message)
V = TypeVar("V")

_FINGERPRINT_BYTES = 8


def encode_appendable(message: Message) -> bytes:
    """Return the encoding of a message without its fingerprint; see ``codec.encode``."""
    return encode(message)[_FINGERPRINT_BYTES:]


def decode_appendable(cls: type[M], data: bytes) -> M:
    """Return the message that this or another version of a type encoded.

    Bytes in strings that are not UTF-8, as in a channel's name, are kept (``decode``'s keep_stray).

    Raises:
        DecodeError: A field ends early or has an impossible length.
    """
    try:
        return cast("M", coder(cls).scan(data, 0)[0])
    except NOT_PLAIN:  # shorter, or damaged
        cursor = Cursor(data, 0, STRAY_BYTES)
    try:
        return cast("M", coder(cls).read_available(cursor))
    except Malformed as malformed:
        raise DecodeError(f"broken {type_name(cls)}: {malformed}") from None


def appendables(messages: Iterable[Message]) -> list[Appendable]:
    """Return messages as elements of an array whose type may grow."""
    found = []
    for message in messages:
        appendable = Appendable()
        appendable.data = encode_appendable(message)
        found.append(appendable)
    return found


class Binding(Generic[M, V]):
    """A struct and the value that it carries: the fields of one name are the same.

    Tuples are arrays.

    Args:
        struct: The struct.
        value: The value's class, a named tuple or a dataclass.
        without: Fields with the same name that are not the same.
        converted: How to write, and how to read, the fields that differ.
    """

    def __init__(
        self,
        struct: type[M],
        value: type[V],
        without: Collection[str] = (),
        **converted: tuple[Callable[[Any], object], Callable[[Any], object]],
    ) -> None:
        own = set(struct.__slots__).difference(without, converted)
        names: Iterable[str] = value.__match_args__  # type: ignore[attr-defined]
        empty = struct()
        same = (name for name in names if name in own)
        self._same = {name: isinstance(getattr(empty, name), list) for name in same}
        self._struct, self._value, self._converted = struct, value, converted

    def message(self, value: V, **more: object) -> M:
        """Return the struct of a value, with more fields."""
        for name, is_array in self._same.items():
            field = getattr(value, name)
            more[name] = list(field) if is_array else field
        for name, (write, _) in self._converted.items():
            more[name] = write(getattr(value, name))
        return self._struct(**more)

    def values(self, message: M) -> dict[str, Any]:
        """Return the fields of a value, by name; a reader of ``converted`` may raise its errors."""
        found: dict[str, Any] = {}
        for name, is_array in self._same.items():
            field = getattr(message, name)
            found[name] = tuple(field) if is_array else field
        for name, (_, read) in self._converted.items():
            found[name] = read(getattr(message, name))
        return found

    def value(self, message: M, **more: object) -> V:
        """Return the value that a struct carries, with more fields."""
        return self._value(**self.values(message), **more)

    def appendables(self, values: Iterable[V]) -> list[Appendable]:
        """Return values as elements of an array whose type may grow."""
        return appendables(map(self.message, values))

    def decode(self, data: bytes) -> V:
        """Return an encoded value; DecodeError as in ``decode_appendable``."""
        return self.value(decode_appendable(self._struct, data))

    def all(self, elements: Iterable[Appendable]) -> tuple[V, ...]:
        """Return the values of an array whose type may grow."""
        return tuple(self.decode(one.data) for one in elements)
