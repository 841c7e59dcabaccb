"""What may be done with values in a filter expression: operators, functions, constants.

Belongs here: each operation's meaning and its limits. Must not know messages, nor how an expression
is written. Whole numbers are kept to 64 bits and powers are floating point, so that none of them
can cost more than the arrays it is given.
"""

import ast
import math
import operator
from collections.abc import Callable, Mapping
from typing import TypeAlias, cast

Function: TypeAlias = Callable[..., object]

LARGEST = 2**64
"""Of whole numbers; a message's are 64 bits wide at most."""

ARITHMETIC: Mapping[type[ast.operator], Function] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.Pow: lambda base, exponent: math.pow(number(base), number(exponent)),
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
SIGNS: Mapping[type[ast.unaryop], Callable[[object], object]] = {
    ast.Not: operator.not_,
    ast.USub: lambda value: -number(value),
    ast.UAdd: lambda value: +number(value),
}
LISTS = {"all", "any", "len", "sum"}
"""Functions of exactly one list (``len``: or text)."""
FUNCTIONS: Mapping[str, Function] = {
    "abs": abs,
    "all": all,
    "any": any,
    "len": len,
    "max": max,
    "min": min,
    "round": lambda value, digits=0: _rounded(value, digits),
    "sum": sum,
    **{
        name: getattr(math, name)
        for name in ("sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "hypot")
    },
    **{name: getattr(math, name) for name in ("isnan", "isinf", "isfinite", "degrees", "radians")},
}
CONSTANTS: Mapping[str, float] = {"pi": math.pi}


def element(array: object, index: object) -> object:
    """An element or a slice of an array, or of text.

    Raises:
        LookupError: It has no such element.
    """
    elements = cast("tuple[object, ...]", array)
    try:
        return elements[cast("int", index)]
    except IndexError:
        raise LookupError(f"it has {len(elements)} elements, none at {index}") from None


def comparable(value: object) -> object:
    """A value as it is; lists and bytes as tuples, which equal a tuple that is written."""
    return tuple(value) if isinstance(value, (list, bytes)) else value


def number(value: object) -> float:
    """A value that is a number.

    Raises:
        TypeError: It is none.
    """
    if not isinstance(value, (bool, int, float)):
        raise TypeError(f"a number is needed, not {_kind(value)}")
    return value


def _kind(value: object) -> str:
    kinds: dict[type, str] = {str: "text", tuple: "an array"}
    return kinds.get(type(value), "a message")


def bounded(value: object) -> object:
    """A result as it is.

    Raises:
        OverflowError: It is a whole number larger than 64 bits.
    """
    if isinstance(value, int) and abs(value) > LARGEST:
        raise OverflowError("the number is larger than 64 bits")
    return value


def _rounded(value: object, digits: object) -> float:
    if not isinstance(digits, int) or not 0 <= digits <= 15:  # noqa: PLR2004 - a double's digits
        raise ValueError("the digits are a whole number from 0 to 15")
    return round(number(value), digits)
