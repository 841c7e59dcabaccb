"""Enums: LCM's named int32 values.

Belongs here: the class of an enum, which replaces lcm-gen's own, whose structs cannot create it,
and the type of a field that holds one. Must not know messages.
"""

import struct
from collections.abc import Mapping
from typing import BinaryIO, ClassVar


class EnumValue(int):
    """A value of an enum, with the interface that lcm-gen's code requires of a field's class."""

    __members__: ClassVar[Mapping[str, int]] = {}
    __hash_number__: ClassVar[int] = 0

    def __repr__(self) -> str:
        """Return its name, or its number if it has none."""
        return str(name_of(int(self), self.__members__))

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

    __slots__ = ("name", "values")

    name: str  # "mode_t"
    values: Mapping[str, int]


def enum_class(name: str, module: str, values: Mapping[str, int], number: int) -> type[EnumValue]:
    """Return the class of an enum; ``number`` is its hash."""
    space = {"__module__": module, "__members__": values, "__hash_number__": number}
    cls = type(name, (EnumValue,), space)
    for value, of in values.items():
        setattr(cls, value, cls(of))
    return cls


def enum_type(cls: type[EnumValue]) -> EnumType:
    """Return the type of fields that hold an enum."""
    found = EnumType("int32")
    found.name, found.values = cls.__name__, cls.__members__
    return found


def name_of(value: int, values: Mapping[str, int]) -> str | int:
    """Return the first name of a value, or the value if it has none."""
    return next((name for name, number in values.items() if number == value), value)
