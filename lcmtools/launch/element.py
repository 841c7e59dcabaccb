"""A launch file as a tree of elements, whichever kind of file it was.

Belongs here: what both readers make and the meaning is worked out from. It knows no tag.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from lcmtools.errors import InvalidFile

DEEPEST = 50
"""Levels of elements in each other, and of files that include each other."""
LARGEST = 1_000_000
"""Bytes of a file."""


@dataclass(frozen=True, slots=True)
class Element:
    """A tag of XML, or what means the same in YAML.

    Attributes:
        tag: What it is: node, remap, param...
        source: The file, for messages.
        line: Where it begins, from 1.
        attributes: As written, before anything is put in.
        children: The elements in it.
        text: What stands in it besides.
    """

    tag: str
    source: str
    line: int
    attributes: Mapping[str, str] = field(default_factory=dict)
    children: tuple["Element", ...] = ()
    text: str = ""

    @property
    def place(self) -> str:
        """Where it is, for messages."""
        return f"{self.source}:{self.line}"

    def error(self, reason: str, hint: str = "") -> InvalidFile:
        """The error that says what is wrong with it, to be raised by the caller."""
        return InvalidFile(f"{self.place}: {reason}", hint)
