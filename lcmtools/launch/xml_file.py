"""XML as elements, with their lines.

Belongs here: XML's own rules. Entities and document types are refused: no launch file needs them,
and a few lines of them can fill the memory. What a tag means is not known here.
"""

import re
from xml.parsers import expat

from lcmtools.errors import InvalidFile
from lcmtools.launch.element import DEEPEST, Element

_CURLY = re.compile("[\u201c\u201d\u2018\u2019]")
_NUMBERED = re.compile(r"\s*\d+\s*<")


class _Open:
    """An element whose end has not come yet."""

    def __init__(self, tag: str, attributes: dict[str, str], line: int) -> None:
        self.tag = tag
        self.attributes = attributes
        self.line = line
        self.children: list[Element] = []
        self.text: list[str] = []

    def closed(self, source: str) -> Element:
        return Element(
            self.tag,
            source,
            self.line,
            self.attributes,
            tuple(self.children),
            "".join(self.text),
        )


class _Reader:
    """Takes what expat finds; makes the tree."""

    def __init__(self, source: str) -> None:
        self._source = source
        self._open: list[_Open] = []
        self.root: Element | None = None
        self._parser = expat.ParserCreate()
        self._parser.buffer_text = True
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.CharacterDataHandler = self._take_text
        self._parser.StartDoctypeDeclHandler = self._refuse_doctype

    def read(self, text: bytes) -> None:
        self._parser.Parse(text, True)  # noqa: FBT003 - expat's signature

    def unclosed(self) -> str:
        """What to close where the text broke off or closes something else; "" for nothing."""
        if not self._open:
            return ""
        last = self._open[-1]
        return (
            f"is the <{last.tag}> of line {last.line} closed? </{last.tag}>, or <{last.tag} ... />"
        )

    def _error(self, reason: str, hint: str = "") -> InvalidFile:
        return InvalidFile(f"{self._source}:{self._parser.CurrentLineNumber}: {reason}", hint)

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        if len(self._open) == DEEPEST:
            raise self._error(f"nested more than {DEEPEST} levels deep")
        self._open.append(_Open(tag, attributes, self._parser.CurrentLineNumber))

    def _end(self, _tag: str) -> None:
        element = self._open.pop().closed(self._source)
        if self._open:
            self._open[-1].children.append(element)
        else:
            self.root = element

    def _take_text(self, text: str) -> None:
        if self._open:
            self._open[-1].text.append(text)

    def _refuse_doctype(self, *_: object) -> None:
        raise self._error("a launch file has no DOCTYPE and no entities", "leave them out")


def read_xml(text: bytes, source: str) -> Element:
    """The root of a file, which is a ``launch`` tag.

    Raises:
        InvalidFile: It is no XML, or no launch file; with the line.
    """
    reader = _Reader(source)
    try:
        reader.read(text)
    except expat.ExpatError as error:
        reason = expat.errors.messages[error.code]
        hint = _hint(text, error.lineno) or reader.unclosed()
        raise InvalidFile(f"{source}:{error.lineno}: not XML: {reason}", hint) from None
    except (LookupError, ValueError) as error:  # an encoding that is none
        raise InvalidFile(f"{source}:1: not XML: {error}", "write it in UTF-8") from None
    root = reader.root
    assert root is not None  # expat refuses a text without one
    if root.tag != "launch":
        raise root.error(f"expected <launch>, got <{root.tag}>", "put all into <launch></launch>")
    return root


def _hint(text: bytes, line: int) -> str:
    """What is often wrong with lines that were copied from a document."""
    rows = text.decode(errors="replace").splitlines()
    row = rows[line - 1] if 0 < line <= len(rows) else ""
    if _CURLY.search(row):
        return 'write straight quotes, as in name="driver"'
    if _NUMBERED.match(row):
        return "take the line numbers out"
    return ""
