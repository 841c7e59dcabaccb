"""Single values: what a number, a boolean or a text of a field may be, and how it is written.

Belongs here: from text or from any Python object to the one plain value that a primitive type
holds. Must not know fields, messages or YAML's syntax.
"""

import math
import operator
import re
import struct
from collections.abc import Callable
from typing import SupportsFloat

from lcmtools.messages.misfit import Misfit, given

Scalar = bool | int | float | str

INTEGERS = {
    "uint8": (0, 255),
    "int8": (-(1 << 7), (1 << 7) - 1),
    "int16": (-(1 << 15), (1 << 15) - 1),
    "int32": (-(1 << 31), (1 << 31) - 1),
    "int64": (-(1 << 63), (1 << 63) - 1),
}
"""The integer types and their ranges, both ends included."""

_BASED = re.compile(r"([-+]?)0(?:x[0-9a-f]+|o[0-7]+|b[01]+)", re.IGNORECASE)
_WHOLE = re.compile(r"[-+]?[0-9]+")
_DECIMAL = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:e[-+]?[0-9]+)?", re.IGNORECASE)
_NOT_FINITE = re.compile(r"[-+]?(?:\.?(?:inf|nan)|infinity)", re.IGNORECASE)
_BOOLEANS = dict.fromkeys(("true", "yes", "on", "1"), True) | dict.fromkeys(
    ("false", "no", "off", "0"), False
)
STRAY_BYTES = "surrogateescape"
"""The error handler for bytes that are not UTF-8: byte 0xE9 becomes the surrogate U+DCE9."""
_LONGEST_NUMBER = 400
"""Characters. No longer text is a number that anyone means; Python refuses far longer ones."""


def from_text(text: str, type_name: str) -> Scalar:
    """The value that ``text`` stands for in a field of a primitive type.

    The field decides, not the text: "on" is text in a string and true in a bool.

    Raises:
        Misfit: It stands for none.
    """
    return _reader(type_name)(text, type_name)


def from_python(value: object, type_name: str) -> Scalar:
    """The plain Python value of a primitive type that ``value`` is, numpy's scalars included.

    Raises:
        Misfit: It is of another type or out of range.
    """
    item = getattr(value, "item", None)  # numpy's scalars
    plain = item() if callable(item) and getattr(value, "shape", None) == () else value
    if type_name == "string":
        return _check_text(plain)
    if type_name == "bool":
        return _check_boolean(plain)
    if type_name in INTEGERS:
        return _check_integer(plain, type_name)
    return _check_float(plain, type_name)


def _reader(type_name: str) -> Callable[[str, str], Scalar]:
    if type_name == "string":
        return _read_text
    if type_name == "bool":
        return _read_boolean
    return _read_integer if type_name in INTEGERS else _read_float


def _read_text(text: str, _: str) -> str:
    return _check_text(text)


def _read_boolean(text: str, _: str) -> bool:
    try:
        return _BOOLEANS[text.lower()]
    except KeyError:
        raise Misfit(f"expected true or false, got {given(text)}") from None


def _read_integer(text: str, type_name: str) -> int:
    if len(text) <= _LONGEST_NUMBER:
        if _WHOLE.fullmatch(text):
            return _in_range(int(text), type_name, text)
        if _BASED.fullmatch(text):
            return _in_range(int(text, 0), type_name, text)
        if _DECIMAL.fullmatch(text):
            return _whole_number(text, type_name)
    raise Misfit(f"expected an integer, got {given(text)}")


def _whole_number(text: str, type_name: str) -> int:
    """An integer that is written with a point or an exponent (5.0, 1e3)."""
    from decimal import Decimal, InvalidOperation

    try:
        number = Decimal(text)
    except InvalidOperation:  # an exponent that even Decimal cannot hold
        raise Misfit(f"expected an integer, got {given(text)}") from None
    low, high = INTEGERS[type_name]
    if not low <= number <= high:  # before int(): 1e999999 would fill the memory
        raise Misfit(_does_not_fit(text, type_name))
    if number != int(number):
        raise Misfit(f"expected an integer, got {given(text)}")
    return int(number)


def _read_float(text: str, type_name: str) -> float:
    if _NOT_FINITE.fullmatch(text):
        return float(text.replace(".", ""))
    if len(text) <= _LONGEST_NUMBER:
        if _DECIMAL.fullmatch(text):
            return _finite(float(text), type_name, text)
        if _BASED.fullmatch(text):
            return _finite(int(text, 0), type_name, text)
    raise Misfit(f"expected a number, got {given(text)}")


def _finite(number: float, type_name: str, shown: object) -> float:
    """A number that was written with digits, if the type can hold it."""
    try:
        value = float(number)
        struct.pack(">f" if type_name == "float32" else ">d", value)
    except OverflowError:
        value = math.inf
    if math.isinf(value):
        raise Misfit(f"{shown} does not fit {type_name}")
    return value


def _check_text(value: object) -> str:
    if not isinstance(value, str):
        raise Misfit(f"expected text, got {given(value)}")
    try:
        value.encode("utf-8", STRAY_BYTES)
    except UnicodeEncodeError:
        raise Misfit(f"expected text, got half a character in {given(value)}") from None
    return value


def _check_boolean(value: object) -> bool:
    if isinstance(value, int) and value in (0, 1):  # bool is an int
        return bool(value)
    raise Misfit(f"expected true or false, got {given(value)}")


def _check_integer(value: object, type_name: str) -> int:
    try:
        number = operator.index(value)  # type: ignore[arg-type] # TypeError says that it has none
    except TypeError:
        raise Misfit(f"expected an integer, got {given(value)}") from None
    return _in_range(number, type_name, number)


def _check_float(value: object, type_name: str) -> float:
    if not isinstance(value, (int, float)):
        value = _to_float(value)
    if isinstance(value, float) and not math.isfinite(value):
        return value
    return _finite(value, type_name, given(value))


def _to_float(value: object) -> float:
    if not isinstance(value, SupportsFloat):  # text is not, although float() takes it
        raise Misfit(f"expected a number, got {given(value)}")
    try:
        return float(value)
    except (TypeError, ValueError):
        raise Misfit(f"expected a number, got {given(value)}") from None


def _in_range(number: int, type_name: str, shown: object) -> int:
    low, high = INTEGERS[type_name]
    if not low <= number <= high:
        raise Misfit(_does_not_fit(shown, type_name))
    return number


def _does_not_fit(shown: object, type_name: str) -> str:
    low, high = INTEGERS[type_name]
    return f"{shown} does not fit {type_name} ({low}..{high})"
