"""Structs that may grow: LCM's encoding without a fingerprint; later versions append fields.

A reader ignores bytes after the fields that it knows, and leaves fields for which no bytes are left
at their defaults. DDS-XTypes calls such types appendable. Fields are never removed, changed or
inserted, and a nested struct that may grow is itself an array of bytes (lcmtools_msgs/Appendable).
"""

from collections.abc import Iterable
from typing import TypeVar, cast

from lcmtools.errors import DecodeError
from lcmtools.messages.codec import NOT_PLAIN, encode
from lcmtools.messages.coder import coder
from lcmtools.messages.registry import Message, type_name
from lcmtools.messages.rows import Cursor, Malformed
from lcmtools.messages.scalars import STRAY_BYTES
from lcmtools.types.lcmtools_msgs import Appendable

M = TypeVar("M", bound=Message)

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
