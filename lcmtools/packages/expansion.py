"""The sizes of types whose fields' types are written out, counted before any of them is used.

A few lines make a type that contains the one before it twice, and that one its own. lcm-gen's code,
layouts and definitions would have all of these fields.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

MOST_FIELDS = 20_000
"""Of a type with those of its fields' types; code for so many is compiled in about a second."""
DEEPEST = 100
"""The maximum depth of types within types."""
_MOST_VISITS = (
    10_000  # of types within one that may contain itself, whose parts count anew each time
)


class TooManyFields(Exception):  # noqa: N818 - named for what it has
    """A type has too many fields, or its types are nested too deeply; the text says which."""


class _Size(NamedTuple):
    fields: int
    depth: int
    is_fixed: bool = True  # the same wherever the type is


class Expansion:
    """Counts fields: ``counts`` has those of each type, ``parts`` the types of those that have any.

    A type is its place in a set.
    """

    def __init__(self, parts: Mapping[int, Sequence[int]], counts: Mapping[int, int]) -> None:
        self._parts, self._counts = parts, counts
        self._known: dict[int, _Size] = {}
        self._refused: dict[int, str] = {}  # those that contain one are not counted again
        self._visits = 0

    def fields(self, name: int) -> int:
        """Return the number of a type's fields and of theirs; TooManyFields if it is too large."""
        self._visits = 0
        try:
            return self._size(name, ()).fields
        except TooManyFields as error:
            self._refused[name] = str(error)
            raise

    def _size(self, name: int, above: tuple[int, ...]) -> _Size:
        if name in self._refused:
            raise TooManyFields(self._refused[name])
        if name in above:
            return _Size(0, 0, is_fixed=False)
        if (found := self._known.get(name)) is None:
            found = self._sum(name, (*above, name))
        if len(above) + found.depth > DEEPEST:
            raise TooManyFields(f"contains types more than {DEEPEST} levels deep")
        if found.is_fixed:
            self._known[name] = found
        return found

    def _sum(self, name: int, above: tuple[int, ...]) -> _Size:
        self._visits += 1
        total, depth, is_fixed = self._counts.get(name, 0), 0, True
        parts = self._parts.get(name, ())
        if total > MOST_FIELDS:
            raise _too_many()
        for part in parts:
            if len(above) > DEEPEST:
                raise TooManyFields(f"contains types more than {DEEPEST} levels deep")
            one = self._size(part, above)
            total, depth = total + one.fields, max(depth, one.depth)
            is_fixed = is_fixed and one.is_fixed
            if total > MOST_FIELDS or self._visits > _MOST_VISITS:
                raise _too_many()
        return _Size(total, depth + 1, is_fixed)


def _too_many() -> TooManyFields:
    return TooManyFields(f"has more than {MOST_FIELDS} fields, with those of their types")
