"""Single values: the number, boolean or text that a field's primitive type holds.

Belongs here: converting text or any Python object to one plain value, and the error for a value
that does not fit. The error collects its path on the way up, so that values that fit cost nothing.
Must not know fields, messages or YAML's syntax.
"""

import contextlib
import math
import operator
import re
import struct
from typing import TYPE_CHECKING, SupportsFloat

from lcmtools.errors import ValueMismatch
from lcmtools.messages.enums import EnumType

if TYPE_CHECKING:
    from decimal import Decimal

Scalar = bool | int | float | str

INTEGERS = {
    "uint8": (0, 255),
    **{f"int{bits}": (-(1 << bits - 1), (1 << bits - 1) - 1) for bits in (8, 16, 32, 64)},
}
"""The integer types and their ranges, both ends included."""
STRAY_BYTES = "surrogateescape"
"""The error handler for bytes that are not UTF-8: byte 0xE9 becomes the surrogate U+DCE9."""

_BASED = re.compile(r"([-+]?)0(?:x[0-9a-f]+|o[0-7]+|b[01]+)", re.IGNORECASE)
_WHOLE = re.compile(r"[-+]?[0-9]+")
_NUMBER_START = re.compile(r"[-+]?\.?[0-9]")
_DECIMAL = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:e[-+]?[0-9]+)?", re.IGNORECASE)
_NOT_FINITE = re.compile(r"[-+]?(?:\.?(?:inf|nan)|infinity)", re.IGNORECASE)
_BOOLEANS = dict.fromkeys(("true", "yes", "on", "1"), True) | dict.fromkeys(
    ("false", "no", "off", "0"), False
)
_LONGEST_NUMBER = 400  # characters; Python refuses far longer ones, which are never intended
_LONGEST_SHOWN = 40  # characters of a value that an error line repeats


class Misfit(ValueError):  # noqa: N818 - named for what happened, as in errors.py
    """A value that does not fit its field; only in this package; users see ValueMismatch."""

    def __init__(self, what: str, hint: str = "") -> None:
        super().__init__(what)
        self.what = what
        self.hint = hint
        self._steps: list[str] = []

    def inside(self, step: str) -> "Misfit":
        """Add the field (".name") or array element ("[3]") around the value; return the error."""
        self._steps.append(step)
        return self

    def mismatch(self, root: str) -> ValueMismatch:
        """Return the error for the user; the type's name ``root`` replaces an empty path."""
        path = "".join(reversed(self._steps)).removeprefix(".")
        says_root = not path and self.what.startswith(f"{root} ")
        return ValueMismatch(self.what if says_root else f"{path or root}: {self.what}", self.hint)


def given(value: object) -> str:
    """Return a short description of a value for an error line."""
    if value is None:
        return "nothing"
    if isinstance(value, (list, tuple)):
        return "a list"
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, (bytes, bytearray)):
        return "binary data"
    if isinstance(value, (bool, int, float, str)):
        text = repr(value)
        is_long = len(text) > _LONGEST_SHOWN
        return f"{text[: _LONGEST_SHOWN - 4]}...{text[-1]}" if is_long else text
    return f"a {type(value).__name__}"


def from_text(text: str, type_name: str) -> Scalar:
    """Return the value of ``text`` in a field of a primitive type; raise Misfit if it has none.

    The field decides, not the text: "on" is text in a string and true in a bool.
    """
    if isinstance(type_name, EnumType) and not _NUMBER_START.match(text):
        return _named(text, type_name)
    if type_name == "string":
        return _check_text(text)
    if type_name == "bool":
        if text.lower() not in _BOOLEANS:
            raise Misfit(f"expected true or false, got {given(text)}")
        return _BOOLEANS[text.lower()]
    return _read_integer(text, type_name) if type_name in INTEGERS else _read_float(text, type_name)


def from_python(value: object, type_name: str) -> Scalar:
    """Convert a Python or numpy value to a primitive type's Python value; else raise Misfit."""
    item = getattr(value, "item", None)  # numpy's scalars
    plain = item() if callable(item) and getattr(value, "shape", None) == () else value
    if isinstance(type_name, EnumType) and isinstance(plain, str):
        return _named(plain, type_name)
    if type_name == "string":
        return _check_text(plain)
    if type_name == "bool":
        if isinstance(plain, int) and plain in (0, 1):  # bool is an int
            return bool(plain)
        raise Misfit(f"expected true or false, got {given(plain)}")
    check = _check_integer if type_name in INTEGERS else _check_float
    return check(plain, type_name)


def _named(name: str, enum: EnumType) -> int:
    value = enum.number(name)
    if value is None:
        names = ", ".join(enum.cls.__members__)
        raise Misfit(f"{enum.cls.__name__} has no value {given(name)}", f"its values: {names}")
    return value


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
    """Return an integer that is written with a point or an exponent (5.0, 1e3)."""
    from decimal import Decimal, InvalidOperation

    try:
        number = Decimal(text)
    except InvalidOperation:  # an exponent that even Decimal cannot hold
        raise Misfit(f"expected an integer, got {given(text)}") from None
    if number != (whole := _in_range(number, type_name, text)):
        raise Misfit(f"expected an integer, got {given(text)}")
    return whole


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
    """Return a number that was written with digits, if it is in the type's range."""
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


def _check_integer(value: object, type_name: str) -> int:
    try:
        number = operator.index(value)  # type: ignore[arg-type] # TypeError if it is not an integer
    except TypeError:
        raise Misfit(f"expected an integer, got {given(value)}") from None
    return _in_range(number, type_name, number)


def _check_float(value: object, type_name: str) -> float:
    number = value if isinstance(value, (int, float)) else None
    if number is None and isinstance(value, SupportsFloat):  # not text, although float() accepts it
        with contextlib.suppress(TypeError, ValueError):
            number = float(value)
    if number is None:
        raise Misfit(f"expected a number, got {given(value)}")
    if isinstance(number, float) and not math.isfinite(number):
        return number
    return _finite(number, type_name, given(number))


def _in_range(number: "int | Decimal", type_name: str, shown: object) -> int:
    low, high = INTEGERS[type_name]
    if not low <= number <= high:  # before int(): 1e999999 would fill the memory
        raise Misfit(f"{shown} does not fit {type_name} ({low}..{high})")
    return int(number)
