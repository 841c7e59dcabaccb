"""Arithmetic on one number, or on an array with a number for each of many robots.

A formula that takes its functions from here is written once for both: a single robot is faster by
plain floats, and a fleet by arrays.
"""

import math
from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np

Value: TypeAlias = float
"""A float, or an array of floats: operators are the same for both. Type checkers see a float."""


class Arithmetic(NamedTuple):
    """The functions that floats and arrays do not share as operators."""

    absolute: Callable[[Value], Value]
    minimum: Callable[[Value, Value], Value]
    maximum: Callable[[Value, Value], Value]
    hypot: Callable[[Value, Value], Value]
    sin: Callable[[Value], Value]
    cos: Callable[[Value], Value]


FLOATS = Arithmetic(abs, min, max, math.hypot, math.sin, math.cos)
ARRAYS = Arithmetic(np.abs, np.minimum, np.maximum, np.hypot, np.sin, np.cos)


def arithmetic_of(value: Value) -> Arithmetic:
    """The functions for this value."""
    return FLOATS if type(value) is float else ARRAYS
