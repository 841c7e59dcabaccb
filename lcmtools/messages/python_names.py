"""Names that LCM allows and Python cannot spell: ``from`` is ``from_`` in Python.

Belongs here: which names these are, and the fingerprint of a type that is generated with others.
Must not know files or lcm-gen's output.
"""

from collections.abc import Collection, Iterable
from functools import cache, lru_cache
from itertools import chain
from keyword import iskeyword

from lcmtools.message_value import MessageValue

_MEMBERS = {
    *("encode", "decode", "get_hash", "_encode_one", "_decode_one", "_get_hash_recursive"),
    *("_get_packed_fingerprint", "_packed_fingerprint"),
    *("__slots__", "__typenames__", "__dimensions__", "__renamed__", "__lcm_name__"),
    "__constant_types__",
    *dir(MessageValue),
}
"""The members of lcm-gen's classes, and those that lcmtools adds."""

_START, _ENUM_START = 0x12345678, 0x87654321
_BITS, _SIGN = (1 << 64) - 1, 1 << 8

HashedField = tuple[str, str, tuple[int | str, ...]]
"""A field's name, its type by LCM's name ("" for another message), and its array sizes."""


def python_name(name: str, others: Collection[str] = ()) -> str:
    """Return a name as it is in Python: with "_" if that needs it, and unlike all ``others``."""
    if not _is_taken(name):
        return name
    while _is_taken(name) or name in others:
        name += "_"
    return name


def python_path(path: str) -> str:
    """Return a path of packages and types, joined by dots, as it is in Python."""
    return ".".join(map(python_name, path.split(".")))


def base_hash(parts: Iterable[HashedField]) -> int:
    """Return the part of a fingerprint that lcm-gen computes from the fields themselves.

    See lcm-proj/lcm, lcmgen/lcmgen.c.
    """
    value = _START
    for part in parts:
        value = _after(value, part)
    return value


@lru_cache(maxsize=1 << 16)
def _after(value: int, part: HashedField) -> int:
    """Return the hash of a field and of those before it, which types that are compared share."""
    return _hash(value, _hashed_bytes(part))


def _hash(value: int, data: Iterable[int]) -> int:
    for byte in data:
        high = value >> 55  # as of a signed number
        value = ((value << 8 ^ (high if high < _SIGN else high - 2 * _SIGN)) + byte) & _BITS
    return value


def enum_hash(name: str) -> int:
    """Return the fingerprint of an enum, by its name without the package."""
    return _hash(_ENUM_START, _hashed_text(name))


def _is_taken(name: str) -> bool:
    is_mangled = name.startswith("__") and not name.endswith("__")
    return is_mangled or iskeyword(name) or name in _MEMBERS


@cache
def _hashed_bytes(part: HashedField) -> tuple[int, ...]:
    """Return the bytes that lcm-gen hashes for a field."""
    name, primitive, dimensions = part
    sizes = ((isinstance(size, str), *_hashed_text(str(size))) for size in dimensions)
    kind = _hashed_text(primitive) if primitive else ()
    return (*_hashed_text(name), *kind, len(dimensions), *chain.from_iterable(sizes))


def _hashed_text(name: str) -> tuple[int, ...]:
    data = name.encode()
    return len(data), *(byte - 256 if byte > 127 else byte for byte in data)  # noqa: PLR2004 - char
