"""An XML text as a tree that remembers its lines, so that every complaint can name one.

For URDF and SDF files, which come from anywhere: what could make a small file huge (entities, and
the DTDs that declare them) or the reader deep is refused. What the elements mean is not known here.
"""

import math
import xml.parsers.expat
from collections.abc import Sequence
from dataclasses import dataclass, field
from xml.parsers.expat import ErrorString

from lcmtools.errors import InvalidFile
from lcmtools_sim.rotation import Vector

_DEEPEST = 64
_LARGEST = 1e6
"""Of the numbers that may stand for lengths, masses and angles."""


@dataclass(slots=True)
class Element:
    """One element of the document.

    Attributes:
        tag: Its name.
        source: The file that it comes from, for messages.
        line: Where it begins, from 1.
        attributes: As they are written.
        children: In their order.
        text: What stands in it, without the text of its children.
    """

    tag: str
    source: str
    line: int
    attributes: dict[str, str]
    children: list["Element"] = field(default_factory=list)
    text: str = ""

    def error(self, reason: str, hint: str = "") -> InvalidFile:
        """The error that says what is wrong with this element, to be raised by the caller."""
        return InvalidFile(f"{self.source}:{self.line}: {reason}", hint)

    def child(self, tag: str) -> "Element | None":
        """The first child of this name."""
        return next((child for child in self.children if child.tag == tag), None)

    def all(self, tag: str) -> list["Element"]:
        """The children of this name."""
        return [child for child in self.children if child.tag == tag]

    def path(self, *tags: str) -> "Element | None":
        """What one gets to by the first children of these names."""
        found: Element | None = self
        for tag in tags:
            found = found.child(tag) if found else None
        return found

    def needed(self, tag: str) -> "Element":
        """The child of this name.

        Raises:
            InvalidFile: There is none.
        """
        if found := self.child(tag):
            return found
        raise self.error(f"{self} lacks <{tag}>")

    def attribute(self, name: str) -> str:
        """What an attribute says, without spaces around it.

        Raises:
            InvalidFile: There is none, or it says nothing that can be shown.
        """
        return self._checked(self.attributes.get(name), f"lacks the attribute '{name}'")

    def words(self) -> str:
        """What stands in the element.

        Raises:
            InvalidFile: Nothing does, or it cannot be shown.
        """
        return self._checked(self.text, "is empty")

    def number(self, name: str = "", *, lowest: float = -_LARGEST) -> float:
        """The number in an attribute; in the element itself where no name is given."""
        return self.numbers(name, (1,), lowest=lowest)[0]

    def length(self, name: str = "") -> float:
        """A side or radius [m]."""
        return self.number(name, lowest=1e-4)

    def vector(self, name: str = "") -> Vector:
        """Three numbers in an attribute, or in the element itself."""
        x, y, z = self.numbers(name, (3,))
        return x, y, z

    def size(self, name: str = "") -> Vector:
        """The three sides of a box [m]."""
        x, y, z = self.numbers(name, (3,), lowest=1e-4)
        return x, y, z

    def numbers(
        self, name: str, counts: Sequence[int], *, lowest: float = -_LARGEST
    ) -> list[float]:
        """Finite numbers in an attribute ("" for the element itself), as many as ``counts`` says.

        Raises:
            InvalidFile: They are missing, too many or too few, no numbers or out of bounds.
        """
        text = self.attribute(name) if name else self.words()
        what = f"'{name}' of {self}" if name else f"{self}"
        words = text.split()
        if len(words) not in counts:
            wanted = " or ".join(map(str, counts))
            raise self.error(f"{what} must be {wanted} numbers, not '{text}'")
        return [self._number(word, what, lowest) for word in words]

    def __str__(self) -> str:
        """The element as messages call it: with its name where it has one."""
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


def load_markup(text: str, source: str, root: str, hint: str = "") -> Element:
    """The root of an XML document; ``root`` is the name that it must have.

    Args:
        text: The document.
        source: The file's name, for messages.
        root: As above.
        hint: What to do with a document about something else.

    Raises:
        InvalidFile: The text is no XML, has a DTD, or is about something else.
    """
    reader = _Reader(source)
    try:
        reader.parser.Parse(text.encode(), True)  # noqa: FBT003 - expat's "this is all"
    except xml.parsers.expat.ExpatError as error:
        reason = ErrorString(error.code) or "not well-formed"
        raise InvalidFile(f"{source}:{error.lineno}: not XML: {reason}") from None
    found = reader.root
    if found.tag != root:
        raise found.error(f"the file is about <{found.tag}>, not <{root}>", hint)
    return found


class _Reader:
    """Builds the tree while expat reads."""

    def __init__(self, source: str) -> None:
        self.parser = xml.parsers.expat.ParserCreate("utf-8")
        self.parser.buffer_text = True  # else every line comes for itself
        self.parser.buffer_size = 1 << 20
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._text
        self.parser.StartDoctypeDeclHandler = self._doctype
        self._source = source
        self._open = [Element("", source, 1, {})]

    @property
    def root(self) -> Element:
        return self._open[0].children[0]

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        element = Element(tag, self._source, self.parser.CurrentLineNumber, attributes)
        if len(self._open) > _DEEPEST:
            raise element.error("nested too deeply")
        self._open[-1].children.append(element)
        self._open.append(element)

    def _end(self, _tag: str) -> None:
        self._open.pop()

    def _text(self, text: str) -> None:
        self._open[-1].text += text

    def _doctype(self, *_: object) -> None:
        line = self.parser.CurrentLineNumber
        raise InvalidFile(
            f"{self._source}:{line}: a document type (<!DOCTYPE>) is not read", "remove it"
        )
