"""Enums: LCM's named int32 values.

Belongs here: the class of an enum, which replaces lcm-gen's own, whose structs cannot create it,
and the type of a field that holds one. Must not know messages.
"""

import struct
from collections.abc import Mapping
from functools import cache
from typing import BinaryIO, ClassVar


class EnumValue(int):
    """A value of an enum, with the interface that lcm-gen's code requires of a field's class."""

    __members__: ClassVar[Mapping[str, int]] = {}
    __hash_number__: ClassVar[int] = 0
    __file__: ClassVar[str] = ""  # that defines it

    def __repr__(self) -> str:
        """Return its name, or its number if it has none."""
        return str(enum_type(type(self)).plain(self))

    def __eq__(self, other: object) -> bool:
        """Return True for the same number, and for its name."""
        if isinstance(other, str):
            return self.__members__.get(other) == int(self)
        return int(self) == other

    def __ne__(self, other: object) -> bool:
        """Return the opposite of ``==``."""
        return not self == other

    __hash__ = int.__hash__

    def __copy__(self) -> "EnumValue":
        """Return itself: it cannot be changed."""
        return self

    def __deepcopy__(self, _: object) -> "EnumValue":
        """Return itself."""
        return self

    def __reduce__(self) -> tuple[object, ...]:
        """Return the enum with its values: a process that unpickles it may not know the type."""
        cls = type(self)
        members = tuple(cls.__members__.items())
        return _unpickled, (enum_name(cls), cls.__module__, members, cls.__hash_number__, int(self))

    @classmethod
    def _get_hash_recursive(cls, parents: object) -> int:  # noqa: ARG003 - lcm-gen's interface
        return cls.__hash_number__

    @classmethod
    def _get_packed_fingerprint(cls) -> bytes:
        return struct.pack(">Q", cls.__hash_number__)

    def _encode_one(self, buffer: BinaryIO) -> None:
        buffer.write(struct.pack(">i", self))

    @classmethod
    def _decode_one(cls, buffer: BinaryIO) -> "EnumValue":
        return cls(struct.unpack(">i", buffer.read(4))[0])


class EnumType(str):
    """The type of a field that holds an enum: "int32", whose values have names."""

    __slots__ = ("cls",)

    cls: type[EnumValue]

    def plain(self, value: int) -> str | int:
        """Return the name of a value, or the value if it has none."""
        names = (name for name, number in self.cls.__members__.items() if number == value)
        return next(names, int(value))

    def number(self, name: object) -> int | None:
        """Return the value with a name; None if there is none."""
        return self.cls.__members__.get(name) if isinstance(name, str) else None


def enum_class(name: str, module: str, values: Mapping[str, int], number: int) -> type[EnumValue]:
    """Return the class of an enum; ``number`` is its hash."""
    space = {"__module__": module, "__members__": values, "__hash_number__": number}
    cls = type(name.rpartition("/")[2], (EnumValue,), {**space, "__lcm_name__": name})
    for value, of in values.items():
        setattr(cls, value, cls(of))
    return cls


@cache
def _pickled_class(
    name: str, module: str, members: tuple[tuple[str, int], ...], number: int
) -> type[EnumValue]:
    return enum_class(name, module, dict(members), number)


def _unpickled(
    name: str, module: str, members: tuple[tuple[str, int], ...], number: int, value: int
) -> EnumValue:
    return _pickled_class(name, module, members, number)(value)


def enum_name(cls: type[EnumValue]) -> str:
    """Return the full name of an enum: "rover/mode_t"."""
    return str(getattr(cls, "__lcm_name__", cls.__name__))


def enum_type(cls: type[EnumValue]) -> EnumType:
    """Return the type of fields that hold an enum."""
    found = EnumType("int32")
    found.cls = cls
    return found
