"""The arrays of numbers in decoded messages.

Belongs here: what they have in addition to ``array.array``, so that code written for lists and
tuples still works. Must not know messages or payloads.
"""

import operator
from array import array
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, SupportsIndex

if TYPE_CHECKING:
    _Array = array[float]
else:
    _Array = array


def _compared(name: str) -> Callable[["NumberArray", object], bool]:
    """Return a comparison that also accepts lists and tuples."""
    own: Callable[[object, object], bool] = getattr(array, name)
    of_lists: Callable[[object, object], bool] = getattr(operator, name)

    def compare(self: "NumberArray", other: object) -> bool:
        if isinstance(other, (list, tuple)):
            return of_lists(type(other)(self), other)
        return own(self, other)

    return compare


class NumberArray(_Array):
    """An ``array.array`` that compares with lists and tuples and prints like a list.

    It contains native numbers ("f" for float32, "b" for int8), so it decodes faster than a list and
    takes less memory, and ``numpy.asarray`` uses it without a copy. A slice is a plain
    ``array.array``: handling slices here, in Python, would make each index slower.
    """

    __slots__ = ()
    __hash__ = None  # it is mutable
    __eq__, __ne__ = _compared("__eq__"), _compared("__ne__")
    __lt__, __le__ = _compared("__lt__"), _compared("__le__")
    __gt__, __ge__ = _compared("__gt__"), _compared("__ge__")

    def __add__(self, other: Iterable[float]) -> list[float]:  # type: ignore[override] # likewise
        """Return a list of these numbers and others; numpy adds its own arrays itself."""
        if not isinstance(other, (list, tuple, array)):
            return NotImplemented
        return [*self, *other]

    def __radd__(self, other: Sequence[float]) -> list[float]:
        """Return a list of other numbers and these."""
        return [*other, *self] if isinstance(other, (list, tuple)) else NotImplemented

    def __mul__(self, times: SupportsIndex) -> list[float]:  # type: ignore[override] # likewise
        """Return a list of these numbers, several times."""
        return self.tolist() * times

    def __copy__(self) -> "NumberArray":
        """Return a copy."""
        return NumberArray(self.typecode, self)

    def __deepcopy__(self, _: object) -> "NumberArray":
        """Return a copy."""
        return NumberArray(self.typecode, self)

    def __repr__(self) -> str:
        """Return the numbers as a list shows them."""
        return repr(self.tolist())
