"""XML parsed into elements with line numbers.

Belongs here: syntax and limits. Document types and entities are refused because a few lines of
them can exhaust the memory. Must not know the meaning of tags.
"""

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeVar

from lcmtools.errors import InvalidFile

if TYPE_CHECKING:
    from xml.parsers.expat import ExpatError, XMLParserType

    from typing_extensions import Self

DEEPEST = 50
"""The maximum depth of nested elements."""

_CURLY = re.compile("[\u201c\u201d\u2018\u2019]")
_NUMBERED = re.compile(r"\s*\d+\s*<")
_QUOTED = re.compile(r"\"[^\"]*\"|'[^']*'")
_MISTAKES = (
    (re.compile(r"&(?!\w+;|#)"), "write & as &amp;"),
    (re.compile(r"=\s*\"[^\"<>]*<"), "write < in a value as &lt;"),
)
"""Patterns of mistakes in a malformed line, with their remedies."""
_MISTAKES_OUTSIDE_QUOTES = (
    (re.compile(r"(?<!<!)--(?!>)"), "a comment cannot contain --"),
    (re.compile(r"=\s*[^\s\"'<>]"), 'write values in quotes, as in name="driver"'),
)


@dataclass(slots=True)
class Element:
    """An XML element with its place in the file."""

    tag: str
    source: str  # the file's name, for errors
    line: int  # where it begins, from 1
    attributes: dict[str, str] = field(default_factory=dict)
    children: list["Self"] = field(default_factory=list)
    text: str = ""  # without its children's text

    @property
    def place(self) -> str:
        """The file and line, for errors."""
        return f"{self.source}:{self.line}"

    def error(self, reason: str, hint: str = "") -> InvalidFile:
        """Return an error at this element, for the caller to raise."""
        return InvalidFile(f"{self.place}: {reason}", hint)


E = TypeVar("E", bound=Element)


def read_xml(content: bytes | str, source: str, kind: type[E]) -> E:
    """Parse a document into elements of class ``kind`` and return the root.

    InvalidFile, with the line, is raised for text that is not XML, has a document type, or is
    nested too deeply.
    """
    from xml.parsers import expat  # late: readers of YAML use elements without a parser

    top = kind("", source, 1)
    parser, open_elements = _parser(top, kind)
    try:
        parser.Parse(content, True)  # noqa: FBT003 - expat's signature
    except expat.ExpatError as error:
        raise _not_xml(content, source, error, open_elements[-1]) from None
    except (LookupError, ValueError) as error:  # an unknown encoding
        raise InvalidFile(f"{source}:1: not XML: {error}", "write it in UTF-8") from None
    return top.children[0]


def _parser(top: E, kind: type[E]) -> "tuple[XMLParserType, list[E]]":
    """Return a parser that adds elements to ``top``, and the list of those that are open."""
    from xml.parsers import expat

    source = top.source
    parser = expat.ParserCreate()
    parser.buffer_text = True  # else each line of text is a call of its own
    open_elements: list[E] = [top]
    texts: list[list[str]] = [[]]  # of the open elements, in pieces

    def start(tag: str, attributes: dict[str, str]) -> None:
        element = kind(tag, source, parser.CurrentLineNumber, attributes)
        if len(open_elements) > DEEPEST:
            raise element.error(f"nested more than {DEEPEST} levels deep")
        open_elements[-1].children.append(element)
        open_elements.append(element)
        texts.append([])

    def end(_tag: str) -> None:
        open_elements.pop().text = "".join(texts.pop())

    def add_text(text: str) -> None:
        texts[-1].append(text)

    def refuse_doctype(*_: object) -> None:
        place = f"{source}:{parser.CurrentLineNumber}"
        raise InvalidFile(f"{place}: a document type (<!DOCTYPE>) is not supported", "remove it")

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = add_text
    parser.StartDoctypeDeclHandler = refuse_doctype
    return parser, open_elements


def _not_xml(content: bytes | str, source: str, error: "ExpatError", last: Element) -> InvalidFile:
    """Return the error for malformed XML; ``last`` is the innermost element before it."""
    from xml.parsers import expat

    reason = expat.errors.messages[error.code]
    hint = _hint(content, error.lineno) or _unclosed(last, reason)
    return InvalidFile(f"{source}:{error.lineno}: not XML: {reason}", hint)


def _hint(content: bytes | str, line: int) -> str:
    """Return a hint for the mistake in a malformed line; "" if it is not a usual one."""
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


def _unclosed(last: Element, reason: str) -> str:
    """Return a hint for an unclosed element; "" if the mistake is another one."""
    if not last.tag or "invalid token" in reason:
        return ""
    return f"is the <{last.tag}> of line {last.line} closed? </{last.tag}>, or <{last.tag} ... />"
