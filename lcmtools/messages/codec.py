"""Messages to payloads and back, with nothing truncated, padded or trusted.

Belongs here: LCM's encoding of whole messages, in the fast way (see ``coder``) and, if that fails,
in a careful way, which names the wrong value. Must not know channels or datagrams. Wire format
(https://lcm-proj.github.io/lcm/): 8 bytes of fingerprint, then the fields in order, big-endian,
without padding. lcm-gen's own code takes an array's length from a field that the user must keep
consistent, and reads a truncated string or byte array as a short one; this code does neither, and
is mostly faster.
"""

import struct
from collections.abc import Sequence
from functools import partial
from typing import TypeVar, cast

from lcmtools.errors import DecodeError
from lcmtools.messages.array_codec import Cursor, Malformed
from lcmtools.messages.coder import Write, coder
from lcmtools.messages.fields import Field, visible_fields
from lcmtools.messages.layout import has_wire_type, is_generated
from lcmtools.messages.reading import Scan
from lcmtools.messages.registry import Message, candidates, fingerprint, type_name, versioned
from lcmtools.messages.scalars import STRAY_BYTES, Misfit, from_python, given
from lcmtools.messages.shape import Element, check_lengths, inner_lengths, shaped

M = TypeVar("M", bound=Message)

_FINGERPRINT_BYTES = 8
NOT_PLAIN = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError, struct.error)
"""Raised by the fast functions of ``coder`` for anything that they leave to the careful ones."""


def encode(message: Message) -> bytes:
    """Encode a message into a payload.

    Length fields are set from the arrays, here and in nested messages; nothing else of the message
    changes. Arrays may be lists, tuples, numpy arrays and, for bytes, anything bytes-like.
    ValueMismatch names a field with a value of the wrong type, range or size
    ("pose.covariance: expected 36 numbers, got 35").
    """
    cls = type(message)
    try:
        try:
            known = coder(cls)
            return b"".join((known.fingerprint, *known.write(message)))
        except NOT_PLAIN:
            plain, known = _conformed(message, cls), coder(cls)
            return b"".join((known.fingerprint, *known.write(plain)))
    except Misfit as misfit:
        raise misfit.mismatch(type_name(cls)) from None
    except RecursionError:
        raise Misfit("contains itself, or is nested too deeply").mismatch(type_name(cls)) from None


def decode(cls: type[M], payload: bytes | bytearray | memoryview, *, keep_stray: bool = False) -> M:
    """Decode the message in a payload; bytes after its end are ignored, as by LCM's decoders.

    Arrays of uint8 are decoded as bytes; arrays of other numbers as a NumberArray, or a tuple if
    the type fixes a size of at most 64; all others as lists.

    Args:
        cls: The message's class.
        payload: The fingerprint and the fields.
        keep_stray: Decode bytes in strings that are not UTF-8 by Python's "surrogateescape", which
            ``encode`` accepts and ``print`` does not; else as U+FFFD.

    Raises:
        DecodeError: The payload has another type, ends early, or has an impossible length.
    """
    data = payload if isinstance(payload, bytes) else bytes(payload)
    known = coder(cls)
    if not data.startswith(known.fingerprint):
        raise DecodeError(f"expected {type_name(cls)}, got {describe_payload(data)}")
    try:
        return known.scan(data, _FINGERPRINT_BYTES)[0]  # type: ignore[return-value] # a ``cls``
    except NOT_PLAIN:
        cursor = Cursor(data, _FINGERPRINT_BYTES, STRAY_BYTES if keep_stray else "replace")
    try:
        return cast("M", known.read(cursor))
    except Malformed as malformed:
        raise DecodeError(f"broken {type_name(cls)}: {malformed}") from None


class PayloadEncoder:
    """Encodes many messages of a class, with fewer calls than ``encode``."""

    def __init__(self, cls: type[Message]) -> None:
        self._cls = cls
        self._head = fingerprint(cls).to_bytes(_FINGERPRINT_BYTES, "big")
        self._write: Write = self._write_first

    def encode(self, message: Message) -> bytes:
        """Return the payload of a message of the class; raises ValueMismatch as ``encode`` does."""
        try:
            return b"".join((self._head, *self._write(message)))
        except (*NOT_PLAIN, Misfit, RecursionError):  # left to the careful encoder
            return encode(message)

    def _write_first(self, message: object) -> tuple[bytes, ...]:
        self._write = coder(self._cls).write  # late: most publishers send nothing at first
        return self._write(message)


class PayloadDecoder:
    """Decodes many payloads, each as the class whose fingerprint it has, one of several.

    It finds by the payload alone what ``decode`` looks up in the class, which halves the time if
    the thread has slept and its caches are cold.
    """

    def __init__(self, classes: Sequence[type[Message]]) -> None:
        self._classes = {
            fingerprint(cls).to_bytes(_FINGERPRINT_BYTES, "big"): cls for cls in classes
        }
        self._scans: dict[bytes, Scan] = {}  # for the classes that have come, by fingerprint

    def decode(self, payload: bytes) -> Message:
        """Return the message in a payload; DecodeError for another type or a damaged payload."""
        head = payload[:_FINGERPRINT_BYTES]
        try:
            return self._scans[head](payload, _FINGERPRINT_BYTES)[0]
        except NOT_PLAIN:  # first of its class, or one for the careful decoder
            cls = self._classes.get(head)
        if cls is None:
            expected = " or ".join(map(type_name, self._classes.values()))
            raise DecodeError(f"expected {expected}, got {describe_payload(payload)}")
        self._scans[head] = coder(cls).scan
        return decode(cls, payload)


def describe_payload(data: bytes) -> str:
    """Describe an unexpected payload: its type, as far as it is known."""
    if len(data) < _FINGERPRINT_BYTES:
        return f"{len(data)} bytes, which are not an LCM message"
    number = int.from_bytes(data[:_FINGERPRINT_BYTES], "big")
    names = candidates(number)
    return versioned(names[0], number) if names else f"an unknown type (fingerprint {number:#018x})"


def _conformed(message: object, cls: type[Message]) -> Message:
    """Copy a message with only plain values: lists, bytes, Python's own scalars."""
    if not is_generated(cls):
        raise Misfit(f"expected a message, got {given(message)}")
    if not has_wire_type(message, cls):
        kind = cast("type[Message]", type(message))
        got = type_name(kind) if is_generated(kind) else given(message)
        raise Misfit(f"expected {type_name(cls)}, got {got}")
    copy = cls()
    for field in (*visible_fields(cls), *inner_lengths(cls)):
        setattr(copy, field.attribute, _conformed_field(message, field))
    check_lengths(copy)
    return copy


def _conformed_field(message: object, field: Field) -> object:
    value = getattr(message, field.attribute, None)
    element: Element = partial(from_python, type_name=field.type)
    if field.message_class:
        element = partial(_conformed, cls=field.message_class)
    try:
        return shaped(value, field, element) if field.dimensions else element(value)
    except Misfit as misfit:
        misfit.inside(f".{field.name}")
        raise
