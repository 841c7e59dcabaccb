"""Operators, functions and constants of expressions, with their limits.

Powers are floating point, integers have at most 64 bits, and text can only be joined, up to a
limit. So the cost of an operation is at most proportional to its arrays.
"""

import ast
import math
import operator
from array import array
from collections.abc import Callable, Mapping
from typing import TypeAlias

Function: TypeAlias = Callable[..., object]

LARGEST = 2**64
"""The limit of integers; those of a message have at most 64 bits."""
CONSTANTS: Mapping[str, float] = {"pi": math.pi}
_LONGEST_TEXT = 10_000


def _power(base: float, exponent: float) -> float:
    """Return an integer for integers if it has at most 64 bits, as Python does."""
    result = math.pow(base, exponent)
    is_whole = isinstance(base, int) and isinstance(exponent, int) and exponent >= 0
    return base**exponent if is_whole and abs(result) <= LARGEST else result


ARITHMETIC: Mapping[type[ast.operator], Function] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.Pow: _power,
}
COMPARISONS: Mapping[type[ast.cmpop], Function] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.In: lambda value, all_of: value in all_of,
    ast.NotIn: lambda value, all_of: value not in all_of,
}
SIGNS: Mapping[type[ast.unaryop], Function] = {
    ast.Not: operator.not_,
    ast.USub: lambda value: -number(value),
    ast.UAdd: lambda value: +number(value),
}
OF_ONE_LIST = {"all", "any", "len", "sum"}  # len also accepts text
FUNCTIONS: Mapping[str, Function] = {
    "abs": abs,
    "all": all,
    "any": any,
    "len": len,
    "max": max,
    "min": min,
    "sum": sum,
    "round": lambda value, digits=None: _rounded(value, digits),
    **{
        name: getattr(math, name)
        for name in ("sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "hypot")
    },
    **{name: getattr(math, name) for name in ("isnan", "isinf", "isfinite", "degrees", "radians")},
}
"""The functions of every expression."""
_METHODS = (
    *("capitalize", "count", "endswith", "find", "isalpha", "isdigit", "join", "lower", "lstrip"),
    *("rsplit", "rstrip", "split", "startswith", "strip", "title", "upper"),
)


def comparable(value: object) -> object:
    """Convert sequences to tuples, so that ``m.data == (1, 2)`` compares by content."""
    return tuple(value) if isinstance(value, (list, bytes, array)) else value


def number(value: object) -> float:
    """Return a number unchanged; raise TypeError for other values."""
    if not isinstance(value, (bool, int, float)):
        kinds: dict[type, str] = {str: "text", tuple: "an array"}
        raise TypeError(f"a number is needed, not {kinds.get(type(value), 'a message')}")
    return value


def bounded(value: object) -> object:
    """Return a result unchanged; raise OverflowError for an integer of more than 64 bits."""
    if isinstance(value, int) and abs(value) > LARGEST:
        raise OverflowError("the number is larger than 64 bits")
    return value


def joined(left: str, right: str) -> str:
    """Concatenate two texts; raise ValueError if the result is too long."""
    if len(left) + len(right) > _LONGEST_TEXT:
        raise ValueError(f"the text is longer than {_LONGEST_TEXT} characters")
    return left + right


def _replaced(text: str, old: str, new: str) -> str:
    if text.count(old) * len(new) > _LONGEST_TEXT:
        raise ValueError(f"the text is longer than {_LONGEST_TEXT} characters")
    return text.replace(old, new)


TEXT_METHODS: Mapping[str, Function] = {
    **{name: getattr(str, name) for name in _METHODS},
    "replace": _replaced,
}
"""Python's methods of text whose results are not much longer than the text."""


def _rounded(value: object, digits: object) -> float:
    if digits is None:
        return round(number(value))
    if not isinstance(digits, int) or not 0 <= digits <= 15:  # noqa: PLR2004 - a double's digits
        raise ValueError("the digits are a whole number from 0 to 15")
    return round(number(value), digits)
