"""The documents of a text of YAML or JSON, each as soon as its last line is there.

Belongs here: the ends of documents in texts that come line by line and never end. Must not know
messages. A document ends at a line of ``---`` or ``...``; one that is in brackets, as JSON
is, at the line that closes them. JSON's own reader is far faster than YAML's and knows JSON's
escapes (two of four digits each for one character).
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
"""Characters of a document; above LCM's largest message, as text."""

_BREAK = re.compile(r"(?:---|\.\.\.)(?=\s|$)")
_NOTHING = re.compile(r"\s*(?:#.*)?")
_BRACKETS = {"{": "}", "[": "]"}
_LITERALS = re.compile(r"\b(?:true|false)\b")


class Document(NamedTuple):
    """A document: its value for ``fill``, and the line where it starts, from 1."""

    value: Value
    line: int


class _OpenDocument(ValueMismatch):
    """The document ends within brackets; with more lines, it may be right."""


class Documents:
    """Takes a text line by line and returns each document that is complete and not empty.

    With ``keeps_empty`` those between lines of ``---`` too, as echo prints messages without fields;
    such a one has a line, if only a blank one.
    """

    def __init__(self, *, keeps_empty: bool = False) -> None:
        self.count = 0  # documents that have begun; the number of the one that an error is in
        self._keeps_empty = keeps_empty
        self._has_line = False  # before the next line of ---
        self._number = 0  # of the latest line, from 1
        self._lines: list[str] = []
        self._first = 1
        self._length = 0
        self._has_content = False

    def take(self, line: str) -> Iterator[Document]:
        """Take the next line, without its end; return the documents that it completes.

        ValueMismatch is raised for one that is bad, or too long.
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
        """Return the last document, which the text's end completes; ValueMismatch for a bad one."""
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
        """Return the document, if it is in brackets and this line closes them."""
        closing = _BRACKETS.get(self._lines[0][:1]) if self._lines else None
        last = self._lines[-1].rstrip() if closing else ""
        if closing and last.endswith(closing) and not last[0].isspace():
            with suppress(_OpenDocument):
                yield from self.end()

    def _parsed(self) -> list[Document]:
        return list(parse("\n".join(self._lines), self._first))


def parse(text: str, first_line: int = 1) -> Iterator[Document]:
    """Return the documents of a complete text of JSON or YAML; empty ones are left out.

    ValueMismatch is raised for one that is bad, after those before it.
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
    """A command's arguments, each parsed on its own, for ``fill``; ValueMismatch for bad YAML."""
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

    Text that is almost JSON is left to the YAML reader, which names the mistake and its place.
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
    """Return the object; a key that is given twice is for the YAML reader to name."""
    found = dict(pairs)
    if len(found) != len(pairs):
        raise ValueError
    return found


def _as_text(value: Value) -> Value:
    """Return the value with true and false as text, which the type of a field reads."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return {name: _as_text(part) for name, part in value.items()}
    return [_as_text(part) for part in value] if isinstance(value, list) else value
