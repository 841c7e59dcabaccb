"""The comments of a type's file: of the type and of each field.

A comment stands above its field or, in ROS files, after it.
"""

import re
from typing import NamedTuple

_STRUCT = re.compile(r"struct\s+\w+")
_FIELD = re.compile(r"(?!package\b)[\w./]+(?:\[[^\]]*\])*\s+(\w+)(?:\s*\[[^\]]*\])*\s*(?:;|$)")
_UNIT = re.compile(r"\[([^\]]*)\]\s*")


class Comment(NamedTuple):
    """A comment, with the unit that it begins with."""

    text: str = ""
    unit: str = ""  # "" for none


def comments(source: str) -> dict[str, Comment]:
    """Return the comments in a .lcm or .msg file by field; the type's own has the key ""."""
    found: dict[str, Comment] = {}
    above: list[str] = []
    for line in source.splitlines():
        code, comment = _split(line)
        if not code:
            above = above if comment else []
            above += [comment] if comment else []
            continue
        if _STRUCT.match(code):
            found[""] = _comment(" ".join(above))
        elif field := _FIELD.fullmatch(code):
            found[field[1]] = _comment(comment or " ".join(above))
        above = []
    return found


def _split(line: str) -> tuple[str, str]:
    """Split a line into its code and its comment."""
    code, mark, comment = line.partition("//")
    if not mark:
        code, mark, comment = line.partition("#")
    return code.strip(), comment.strip()


def _comment(text: str) -> Comment:
    unit = _UNIT.match(text)
    return Comment(text[unit.end() :], unit[1]) if unit else Comment(text)
