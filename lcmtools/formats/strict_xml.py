"""XML as elements that remember their lines.

Belongs here: syntax and limits. Document types and entities are refused: a few lines of them can
fill the memory. Must not know the meaning of tags.
"""

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeVar

from lcmtools.errors import InvalidFile

if TYPE_CHECKING:
    from typing_extensions import Self

DEEPEST = 50
"""Levels of elements in each other."""

_CURLY = re.compile("[\u201c\u201d\u2018\u2019]")
_NUMBERED = re.compile(r"\s*\d+\s*<")
_QUOTED = re.compile(r"\"[^\"]*\"|'[^']*'")
_MISTAKES = (
    (re.compile(r"&(?!\w+;|#)"), "write & as &amp;"),
    (re.compile(r"=\s*\"[^\"<>]*<"), "write < in a value as &lt;"),
)
"""Mistakes in a line that is not well-formed, and their remedies."""
_MISTAKES_OUTSIDE_QUOTES = (
    (re.compile(r"(?<!<!)--(?!>)"), "a comment cannot contain --"),
    (re.compile(r"=\s*[^\s\"'<>]"), 'write values in quotes, as in name="driver"'),
)


@dataclass(slots=True)
class Element:
    """An element of a document."""

    tag: str
    source: str  # the file that it comes from, for errors
    line: int  # in which it begins, from 1
    attributes: dict[str, str] = field(default_factory=dict)
    children: list["Self"] = field(default_factory=list)
    text: str = ""  # without that of its children

    @property
    def place(self) -> str:
        """File and line, for errors."""
        return f"{self.source}:{self.line}"

    def error(self, reason: str, hint: str = "") -> InvalidFile:
        """Return the error for this element, to be raised by the caller."""
        return InvalidFile(f"{self.place}: {reason}", hint)


E = TypeVar("E", bound=Element)


def read_xml(content: bytes | str, source: str, kind: type[E]) -> E:
    """Return the root of a document, made of elements of a kind.

    InvalidFile, with the line: it is no XML, has a document type, or is nested too deeply.
    """
    from xml.parsers import expat  # elements are made without it, by other readers

    parser = expat.ParserCreate()
    parser.buffer_text = True  # else every line comes for itself
    top = kind("", source, 1)
    open_elements = [top]

    def start(tag: str, attributes: dict[str, str]) -> None:
        element = kind(tag, source, parser.CurrentLineNumber, attributes)
        if len(open_elements) > DEEPEST:
            raise element.error(f"nested more than {DEEPEST} levels deep")
        open_elements[-1].children.append(element)
        open_elements.append(element)

    def take_text(text: str) -> None:
        open_elements[-1].text += text

    def refuse_doctype(*_: object) -> None:
        place = f"{source}:{parser.CurrentLineNumber}"
        raise InvalidFile(f"{place}: a document type (<!DOCTYPE>) is not supported", "remove it")

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _tag: open_elements.pop()
    parser.CharacterDataHandler = take_text
    parser.StartDoctypeDeclHandler = refuse_doctype
    try:
        parser.Parse(content, True)  # noqa: FBT003 - expat's signature
    except expat.ExpatError as error:
        reason = expat.errors.messages[error.code]
        hint = _hint(content, error.lineno) or _unclosed(open_elements, reason)
        raise InvalidFile(f"{source}:{error.lineno}: not XML: {reason}", hint) from None
    except (LookupError, ValueError) as error:  # an encoding that is none
        raise InvalidFile(f"{source}:1: not XML: {error}", "write it in UTF-8") from None
    return top.children[0]


def _hint(content: bytes | str, line: int) -> str:
    """Return the hint for mistakes in lines that were copied from a document."""
    text = content if isinstance(content, str) else content.decode(errors="replace")
    rows = text.splitlines()
    row = rows[line - 1] if 0 < line <= len(rows) else ""
    if _CURLY.search(row):
        return 'write straight quotes, as in name="driver"'
    if _NUMBERED.match(row):
        return "remove the line numbers"
    bare = _QUOTED.sub('""', row)
    found = [hint for pattern, hint in _MISTAKES if pattern.search(row)]
    found += [hint for pattern, hint in _MISTAKES_OUTSIDE_QUOTES if pattern.search(bare)]
    before = "\n".join(rows[: line - 1])
    start = before.rfind("<")
    if start > before.rfind(">"):
        found.append(f"is the tag of line {before.count(chr(10), 0, start) + 1} closed by '>'?")
    return found[0] if found else ""


def _unclosed(elements: list[E], reason: str) -> str:
    """Return the hint for a text that breaks off, or closes another element."""
    last = elements[-1]
    if not last.tag or "invalid token" in reason:
        return ""
    return f"is the <{last.tag}> of line {last.line} closed? </{last.tag}>, or <{last.tag} ... />"
