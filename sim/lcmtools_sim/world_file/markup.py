"""The elements of URDF and SDF files, with readers for their values.

Every error names the file and the line. Must not know what the elements mean.
"""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

from lcmtools.formats import strict_xml
from lcmtools_sim.geometry import Vector
from lcmtools_sim.shapes import Color

_COMMENT = re.compile("<!--.*?-->", re.DOTALL)
_LARGEST = 1e6  # largest length, mass and angle


@dataclass(slots=True)
class Element(strict_xml.Element):
    """An element of a description."""

    def child(self, tag: str) -> "Element | None":
        """Return the first child with this name."""
        return next((child for child in self.children if child.tag == tag), None)

    def all(self, tag: str) -> list["Element"]:
        """Return the children with this name."""
        return [child for child in self.children if child.tag == tag]

    def path(self, *tags: str) -> "Element | None":
        """Return the element reached through the first children with these names."""
        found: Element | None = self
        for tag in tags:
            found = found.child(tag) if found else None
        return found

    def needed(self, tag: str) -> "Element":
        """Return the child with this name, which is required."""
        if found := self.child(tag):
            return found
        raise self.error(f"{self} lacks <{tag}>")

    def attribute(self, name: str) -> str:
        """Return an attribute, which is required, without spaces around it."""
        return self._checked(self.attributes.get(name), f"lacks the attribute '{name}'")

    def words(self) -> str:
        """Return the text of the element, which is required."""
        return self._checked(self.text, "is empty")

    def number(self, name: str = "", *, lowest: float = -_LARGEST) -> float:
        """Return the number in an attribute; without a name, in the element itself."""
        return self.numbers(name, (1,), lowest=lowest)[0]

    def length(self, name: str = "") -> float:
        """Return a side or radius [m]."""
        return self.number(name, lowest=1e-4)

    def vector(self, name: str = "") -> Vector:
        """Return three numbers in an attribute, or in the element itself."""
        x, y, z = self.numbers(name, (3,))
        return x, y, z

    def size(self, name: str = "") -> Vector:
        """Return the three sides of a box [m]."""
        x, y, z = self.numbers(name, (3,), lowest=1e-4)
        return x, y, z

    def numbers(
        self, name: str, counts: Sequence[int], *, lowest: float = -_LARGEST
    ) -> list[float]:
        """Return finite numbers in an attribute ("" for the element itself), one of ``counts``."""
        text = self.attribute(name) if name else self.words()
        what = f"'{name}' of {self}" if name else f"{self}"
        words = text.split()
        if len(words) not in counts:
            wanted = " or ".join(map(str, counts))
            raise self.error(f"{what} must be {wanted} numbers, not '{text}'")
        return [self._number(word, what, lowest) for word in words]

    def color(self, name: str = "") -> Color:
        """Return red, green and blue, 0 to 1; the opacity after them is ignored."""
        red, green, blue, *_ = self.numbers(name, (4,) if name else (3, 4), lowest=0.0)
        return min(red, 1.0), min(green, 1.0), min(blue, 1.0)

    def __str__(self) -> str:
        """Return the element as named in errors: with its name, if it has one."""
        name = self.attributes.get("name", "")
        return f"<{self.tag} name='{name}'>" if name.isprintable() and name else f"<{self.tag}>"

    def _number(self, word: str, what: str, lowest: float) -> float:
        try:
            value = float(word)
        except ValueError:
            raise self.error(f"{what} must be a number, not '{word}'") from None
        if not (math.isfinite(value) and lowest <= value <= _LARGEST):
            raise self.error(f"{what} must be between {lowest:g} and {_LARGEST:g}, not {word}")
        return value

    def _checked(self, text: str | None, fault: str) -> str:
        found = " ".join((text or "").split())
        if not found:
            raise self.error(f"{self} {fault}")
        if not found.isprintable():
            raise self.error(f"{self} has characters that cannot be shown")
        return found


def _emptied(comment: re.Match[str]) -> str:
    """Return a comment without its text, which may have "--" for the readers of URDF and SDF."""
    return "\n" * comment[0].count("\n")


def load_markup(text: str, source: str, root: str, hint: str = "") -> Element:
    """Return the root of an XML document, whose tag must be ``root``.

    InvalidFile if it is no XML, has a document type, or another tag: then ``hint`` is its hint.
    """
    found = strict_xml.read_xml(_COMMENT.sub(_emptied, text), source, Element)
    if found.tag != root:
        raise found.error(f"the file is about <{found.tag}>, not <{root}>", hint)
    return found
