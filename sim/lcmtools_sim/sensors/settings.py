"""Settings of sensors: fields of dataclasses that say in which bounds a world file may set them."""

from dataclasses import field
from typing import TypeVar

Number = TypeVar("Number", int, float)


def number(default: Number, lowest: float, highest: float, *, angle: bool = False) -> Number:
    """A field that is a number within bounds; an angle [rad] may be written as "90 deg".

    Whole where the default is whole.
    """
    bounds = {"lowest": lowest, "highest": highest, "angle": angle}
    return field(default=default, metadata=bounds)


def deviation(default: float = 0.0) -> float:
    """A field that is the standard deviation of a noise, in the unit of what it disturbs."""
    return number(default, 0.0, 1e3)
