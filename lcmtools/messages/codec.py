"""Messages to payloads and back, with nothing cut, padded or believed.

Belongs here: LCM's encoding of whole messages, the fast way (see ``coder``), and the careful one
that is taken when it fails, to name the value that is wrong. Must not know channels or datagrams.
Wire format (https://lcm-proj.github.io/lcm/): 8 bytes of fingerprint, then the fields in order,
big-endian, without padding. lcm-gen's own code takes an array's length from a field that the user
must keep in step, and reads a truncated string or byte array as a short one; this does neither, and
is mostly faster.
"""

import struct
from collections.abc import Sequence
from functools import partial
from typing import TypeVar, cast

from lcmtools.errors import DecodeError
from lcmtools.messages.coder import coder
from lcmtools.messages.compiled import Scan, Write
from lcmtools.messages.fields import Field, visible_fields
from lcmtools.messages.layout import has_wire_type, is_generated
from lcmtools.messages.registry import Message, candidates, fingerprint, type_name
from lcmtools.messages.rows import Cursor, Malformed
from lcmtools.messages.scalars import STRAY_BYTES, Misfit, from_python, given
from lcmtools.messages.shape import Element, check_lengths, shaped

M = TypeVar("M", bound=Message)

_FINGERPRINT_BYTES = 8
_NOT_PLAIN = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError, struct.error)


def encode(message: Message) -> bytes:
    """The payload of a message.

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
        except _NOT_PLAIN:
            plain, known = _conformed(message, cls), coder(cls)
            return b"".join((known.fingerprint, *known.write(plain)))
    except Misfit as misfit:
        raise misfit.mismatch(type_name(cls)) from None
    except RecursionError:
        raise Misfit("contains itself, or is nested too deeply").mismatch(type_name(cls)) from None


def decode(cls: type[M], payload: bytes | bytearray | memoryview, *, keep_stray: bool = False) -> M:
    """The message in a payload; bytes after its end are ignored, as by every LCM decoder.

    Arrays of uint8 come as bytes, of other numbers as a NumberArray, or a tuple where the type
    fixes a size of at most 64; all others as lists.

    Args:
        cls: The message's class.
        payload: The fingerprint and the fields.
        keep_stray: Bytes in strings that are not UTF-8 come as Python's "surrogateescape" has
            them, which ``encode`` takes back, and ``print`` does not; else as U+FFFD.

    Raises:
        DecodeError: The payload is of another type, ends early, or has a length that cannot be.
    """
    data = payload if isinstance(payload, bytes) else bytes(payload)
    known = coder(cls)
    if not data.startswith(known.fingerprint):
        raise DecodeError(f"expected {type_name(cls)}, got {describe_payload(data)}")
    try:
        return known.scan(data, _FINGERPRINT_BYTES)[0]  # type: ignore[return-value] # a ``cls``
    except _NOT_PLAIN:
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
        """Return the payload of a message of the class; ValueMismatch as of ``encode``."""
        try:
            return b"".join((self._head, *self._write(message)))
        except (*_NOT_PLAIN, Misfit, RecursionError):  # for the careful encoder
            return encode(message)

    def _write_first(self, message: object) -> tuple[bytes, ...]:
        self._write = coder(self._cls).write  # most publishers send nothing soon
        return self._write(message)


class PayloadDecoder:
    """Decodes many payloads, each as the one of some classes whose fingerprint it carries.

    It looks up by the payload alone what ``decode`` asks the class for, which takes half the time
    where a thread has slept and its caches are cold.
    """

    def __init__(self, classes: Sequence[type[Message]]) -> None:
        self._classes = {
            fingerprint(cls).to_bytes(_FINGERPRINT_BYTES, "big"): cls for cls in classes
        }
        self._scans: dict[bytes, Scan] = {}  # of the classes that have come

    def decode(self, payload: bytes) -> Message:
        """Return the message in a payload; DecodeError for another type, or a damaged one."""
        head = payload[:_FINGERPRINT_BYTES]
        try:
            return self._scans[head](payload, _FINGERPRINT_BYTES)[0]
        except _NOT_PLAIN:  # the first of its class, or one for the careful decoder
            cls = self._classes.get(head)
        if cls is None:
            expected = " or ".join(map(type_name, self._classes.values()))
            raise DecodeError(f"expected {expected}, got {describe_payload(payload)}")
        self._scans[head] = coder(cls).scan
        return decode(cls, payload)


def describe_payload(data: bytes) -> str:
    """A description of an unexpected payload: its type, as far as it is known."""
    if len(data) < _FINGERPRINT_BYTES:
        return f"{len(data)} bytes, which are not an LCM message"
    number = int.from_bytes(data[:_FINGERPRINT_BYTES], "big")
    names = candidates(number)
    return names[0] if names else f"an unknown type (fingerprint {number:#018x})"


def _conformed(message: object, cls: type[Message]) -> Message:
    """A copy of a message in which all is plain: lists, bytes, Python's own scalars."""
    if not is_generated(cls):
        raise Misfit(f"expected a message, got {given(message)}")
    if not has_wire_type(message, cls):
        kind = cast("type[Message]", type(message))
        got = type_name(kind) if is_generated(kind) else given(message)
        raise Misfit(f"expected {type_name(cls)}, got {got}")
    copy = cls()
    for field in visible_fields(cls):
        setattr(copy, field.name, _conformed_field(message, field))
    check_lengths(copy)
    return copy


def _conformed_field(message: object, field: Field) -> object:
    value = getattr(message, field.name, None)
    element: Element = partial(from_python, type_name=field.type)
    if field.message_class:
        element = partial(_conformed, cls=field.message_class)
    try:
        return shaped(value, field, element) if field.dimensions else element(value)
    except Misfit as misfit:
        misfit.inside(f".{field.name}")
        raise
