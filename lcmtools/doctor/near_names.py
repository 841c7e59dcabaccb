"""Names that look the same and are not. Pure: text in, an answer out."""

import re

_SHORT = 4  # characters: names this short are near each other by chance


def are_near(one: str, other: str) -> bool:
    """Whether two names look like the same: but for case, slashes, spaces or one character.

    Names that differ in their numbers only are of different things (/husky0, /husky1).
    """
    if _are_numbered(one, other):
        return False
    first, second = (re.sub(r"[\s/_]", "", name).casefold() for name in (one, other))
    if first == second:
        return True
    return min(len(first), len(second)) > _SHORT and _is_one_change(first, second)


def _are_numbered(one: str, other: str) -> bool:
    """Whether two names differ in their numbers only."""
    return re.sub(r"[0-9]+", "0", one) == re.sub(r"[0-9]+", "0", other)


def _is_one_change(one: str, other: str) -> bool:
    """Whether a character more, less, changed, or swapped with the next makes one the other."""
    if len(one) > len(other):
        one, other = other, one
    start = next((i for i, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), len(one))
    if len(one) == len(other):
        swapped = one[start : start + 2][::-1] + one[start + 2 :]
        return one[start + 1 :] == other[start + 1 :] or swapped == other[start:]
    return one[start:] == other[start + 1 :]
