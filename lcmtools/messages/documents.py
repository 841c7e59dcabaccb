"""The documents of a text, each as soon as its last line is there.

Belongs here: where a document of YAML or JSON begins and ends, for texts that come line by line
and never end. Must not know messages. A document ends at a line of ``---`` or ``...``; one that is
in brackets, as JSON is, at the line that closes them.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass

from lcmtools.errors import ValueMismatch
from lcmtools.messages.json_input import read_json
from lcmtools.messages.plain import Value
from lcmtools.messages.yaml_problem import OpenBracket, explained, forbidden_character, mismatch
from lcmtools.messages.yaml_tree import BadYaml, Tree

LONGEST = 1 << 28
"""Characters of a document; above LCM's largest message, as text."""

_BREAK = re.compile(r"(?:---|\.\.\.)(?=\s|$)")
_NOTHING = re.compile(r"\s*(?:#.*)?")
_BRACKETS = {"{": "}", "[": "]"}


@dataclass(frozen=True, slots=True)
class Document:
    """One of the documents of a text.

    Attributes:
        value: What is in it, for ``fill``.
        line: The number of the line where it starts, from 1.
    """

    value: Value
    line: int


class Documents:
    """Takes a text line by line and gives back each document that is whole; empty ones are not.

    Attributes:
        count: How many documents have been begun; the number of the one that an error is in.
    """

    def __init__(self) -> None:
        self.count = 0
        self._number = 0  # of the latest line, from 1
        self._lines: list[str] = []
        self._first = 1
        self._length = 0
        self._has_content = False

    def take(self, line: str) -> Iterator[Document]:
        """Take the next line, without its end.

        Raises:
            ValueMismatch: The document that ends here is bad, or too long.
        """
        self._number += 1
        if self._number == 1:
            line = line.removeprefix("\ufeff")
        if _BREAK.match(line):
            if self._has_content:
                yield from self._whole()
            if line.startswith("."):
                return
        self._add(line)
        yield from self._closed_brackets()

    def end(self) -> Iterator[Document]:
        """The last document, which the text's end has made whole.

        Raises:
            ValueMismatch: It is bad.
        """
        if self._lines:
            yield from self._whole()

    def _add(self, line: str) -> None:
        is_content = not _NOTHING.fullmatch(_BREAK.sub("", line))
        is_directive = is_content and not self._has_content and line.startswith("%")
        if not is_content and not self._lines:
            return  # so that an endless text of blank lines takes no memory
        self._first = self._first if self._lines else self._number
        self._lines.append(line)
        self._length += len(line) + 1
        if self._length > LONGEST:
            raise ValueMismatch(f"line {self._number}: the document does not end")
        if is_content and not is_directive and not self._has_content:
            self._has_content = True
            self.count += 1

    def _closed_brackets(self) -> Iterator[Document]:
        """The document, if it is in brackets and this line closes them."""
        closing = _BRACKETS.get(self._lines[0][:1]) if self._lines else None
        last = self._lines[-1].rstrip() if closing else ""
        if closing and last.endswith(closing) and not last[0].isspace():
            try:
                yield from self._parsed()
            except OpenBracket:
                return
            self._begin()

    def _whole(self) -> Iterator[Document]:
        yield from self._parsed()
        self._begin()

    def _parsed(self) -> list[Document]:
        return list(parse("\n".join(self._lines), self._first))

    def _begin(self) -> None:
        self._lines, self._length, self._has_content = [], 0, False


def parse(text: str, first_line: int = 1) -> Iterator[Document]:
    """The documents of a text that is all there; empty ones are left out.

    Args:
        text: JSON, or YAML.
        first_line: The number of its first line.

    Raises:
        ValueMismatch: The YAML is bad; the documents before it have come out by then.
        OpenBracket: It ends within brackets.
    """
    found, value = read_json(text)
    if found:
        yield Document(value, first_line)
        return
    import yaml

    loader = getattr(yaml, "CBaseLoader", yaml.BaseLoader)
    tree = Tree()
    try:
        for event in yaml.parse(text, Loader=loader):
            tree.take(event)
            if isinstance(event, yaml.DocumentEndEvent):
                if tree.root is not None:
                    yield Document(tree.root, first_line + tree.line)
                tree = Tree()
    except BadYaml as bad:
        raise mismatch(bad, first_line) from None
    except yaml.MarkedYAMLError as error:
        raise explained(error, text, first_line) from None
    except (yaml.reader.ReaderError, UnicodeEncodeError):
        raise mismatch(forbidden_character(text), first_line) from None
