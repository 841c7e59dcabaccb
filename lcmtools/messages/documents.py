"""The documents in a text of YAML or JSON, each available as soon as its last line is.

Belongs here: the ends of documents in texts that come line by line and may never end. Must not know
messages. A document ends at a line of ``---`` or ``...``; one in brackets, as in JSON, at the line
that closes them. Python's JSON parser is far faster than the YAML parser, and knows JSON's escapes
(surrogate pairs, two escapes of four digits for one character).
"""

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import NamedTuple

from lcmtools.errors import ValueMismatch
from lcmtools.formats.strict_yaml import read_values
from lcmtools.formats.yaml_problem import BadYaml, OpenBracket
from lcmtools.messages.fill import Value

LONGEST = 1 << 28
"""The most characters of a document; more than LCM's largest message has as text."""

_BREAK = re.compile(r"(?:---|\.\.\.)(?=\s|$)")
_NOTHING = re.compile(r"\s*(?:#.*)?")
_BRACKETS = {"{": "}", "[": "]"}
_LITERALS = re.compile(r"\b(?:true|false)\b")


class Document(NamedTuple):
    """A document: its value for ``fill``, and the line where it starts, from 1."""

    value: Value
    line: int


class _OpenDocument(ValueMismatch):
    """The document ends within brackets; with more lines, it may be correct."""


class Documents:
    """Parses a text line by line and returns each complete document that is not empty.

    With ``keeps_empty`` also returns empty ones between lines of ``---``, which echo prints for
    messages without fields; such a document has at least a blank line.
    """

    def __init__(self, *, keeps_empty: bool = False) -> None:
        self.count = 0  # documents begun; for errors, the number of the current one
        self._keeps_empty = keeps_empty
        self._has_line = False  # True if a line has come since the last line of ---
        self._number = 0  # number of the latest line, from 1
        self._lines: list[str] = []
        self._first = 1
        self._length = 0
        self._has_content = False

    def add_line(self, line: str) -> Iterator[Document]:
        """Add the next line, without its end; return the documents that it completes.

        ValueMismatch is raised for an invalid document or one that is too long.
        """
        self._number += 1
        if self._number == 1:
            line = line.removeprefix("\ufeff")
        if _BREAK.match(line):
            if self._has_content:
                yield from self.end()
            elif self._keeps_empty and self._has_line:
                self.count += 1
                yield Document({}, self._number)
            self._has_line = False
            if line.startswith("."):
                return
        else:
            self._has_line = True
        self._add(line)
        yield from self._closed_brackets()

    def end(self) -> Iterator[Document]:
        """Return the last document, completed by the text's end; ValueMismatch if it is invalid."""
        if self._lines:
            yield from self._parsed()
            self._lines, self._length = [], 0
            self._has_content = self._has_line = False

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
        """Return the document if it is in brackets that this line closes."""
        closing = _BRACKETS.get(self._lines[0][:1]) if self._lines else None
        last = self._lines[-1].rstrip() if closing else ""
        if closing and last.endswith(closing) and not last[0].isspace():
            with suppress(_OpenDocument):
                yield from self.end()

    def _parsed(self) -> list[Document]:
        return list(parse("\n".join(self._lines), self._first))


def parse(text: str, first_line: int = 1) -> Iterator[Document]:
    """Return the documents of a complete text of JSON or YAML; empty ones are left out.

    ValueMismatch is raised for an invalid one, after those before it.
    """
    found, value = _read_json(text)
    if found:
        yield Document(value, first_line)
        return
    try:
        for value, line in read_values(text):
            yield Document(value, first_line + line - 1)
    except BadYaml as bad:
        raise _mismatch(bad, first_line) from None


def parse_values(texts: Sequence[str]) -> Value:
    """Parse a command's arguments separately, for ``fill``; ValueMismatch for invalid YAML."""
    values = [_only_value(text) for text in texts]
    return values[0] if len(values) == 1 else values or {}


def _only_value(text: str) -> Value:
    documents = list(parse(text))
    if len(documents) > 1:
        raise ValueMismatch(f"{len(documents)} YAML documents where one value is expected")
    return documents[0].value if documents else None


def _mismatch(bad: BadYaml, first_line: int) -> ValueMismatch:
    kind = _OpenDocument if isinstance(bad, OpenBracket) else ValueMismatch
    line = first_line + bad.line - 1
    place = f" at line {line}, column {bad.column}" if bad.column else f" from line {line} on"
    return kind(f"bad YAML{place if bad.line else ''}: {bad.problem}", bad.hint)


def _read_json(text: str) -> tuple[bool, Value]:
    """Return True and the value, if a text is one object or array of JSON.

    Text that is almost JSON is left to the YAML reader, which reports the mistake and its place.
    """
    import json

    if not text.lstrip().startswith(("{", "[")):
        return False, None
    try:
        value: Value = json.loads(
            text,
            parse_float=str,
            parse_int=str,
            parse_constant=str,
            object_pairs_hook=_unique_keys,
        )
        return True, _as_text(value) if _LITERALS.search(text) else value
    except (ValueError, RecursionError):
        return False, None


def _unique_keys(pairs: list[tuple[str, Value]]) -> dict[str, Value]:
    """Return the object; a duplicate key is left to the YAML reader to report."""
    found = dict(pairs)
    if len(found) != len(pairs):
        raise ValueError
    return found


def _as_text(value: Value) -> Value:
    """Return the value with true and false as text, to be read by a field's type."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return {name: _as_text(part) for name, part in value.items()}
    return [_as_text(part) for part in value] if isinstance(value, list) else value
