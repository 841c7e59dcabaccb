"""Arithmetic on a single number, or on an array with one number for each of many robots.

A formula that takes its functions from here is written once for both: plain floats are faster for a
single robot, arrays for a fleet.
"""

import math
from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np

Value: TypeAlias = float
"""A float, or an array of floats: both have the same operators.

Type checkers see a float: a union would reach Vector and RobotState, and with them everything that
only ever has a single robot's floats.
"""


class Arithmetic(NamedTuple):
    """The functions that differ between floats and arrays."""

    absolute: Callable[[Value], Value]
    minimum: Callable[[Value, Value], Value]
    maximum: Callable[[Value, Value], Value]
    hypot: Callable[[Value, Value], Value]
    sin: Callable[[Value], Value]
    cos: Callable[[Value], Value]


FLOATS = Arithmetic(abs, min, max, math.hypot, math.sin, math.cos)
ARRAYS = Arithmetic(np.abs, np.minimum, np.maximum, np.hypot, np.sin, np.cos)


def arithmetic_of(value: Value) -> Arithmetic:
    """Return the functions for this value."""
    return FLOATS if type(value) is float else ARRAYS
