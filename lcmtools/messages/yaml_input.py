"""Messages from the YAML that users type: arguments, as ``rostopic pub`` takes them, and files.

Belongs here: which of the YAML in a text is taken, and what is said about the rest. Must not know
types (see ``plain``) nor where the text comes from. Every scalar stays text until the type of a
field says what it is, so that ``1e-3`` is a number and ``on`` a word wherever one is wanted.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeVar

from lcmtools.errors import ValueMismatch
from lcmtools.messages.plain import Value, fill
from lcmtools.messages.registry import Message
from lcmtools.messages.yaml_tree import BadYaml, Tree

M = TypeVar("M", bound=Message)

_JSON_LINE = re.compile(r"\{.*\}\s*|\s*|---\s*|#.*")
_COLON_PROBLEMS = ("mapping values are not allowed", "found unexpected ':'")


@dataclass(frozen=True, slots=True)
class Document:
    """One of the YAML documents of a text.

    Attributes:
        value: What is in it, for ``fill``.
        line: The number of the line where it starts, from 1.
    """

    value: Value
    line: int


def message_from_values(cls: type[M], texts: Sequence[str]) -> M:
    """The message that a user's arguments mean; fields that they do not name are default.

    Args:
        cls: The message's class.
        texts: Each one YAML: nothing; one mapping of fields; one list of all fields in order; all
            fields in order, a text each; or one value for the only field of a message.

    Raises:
        ValueMismatch: The YAML is bad, or a value does not fit the field that it names.
    """
    message = cls()
    fill(message, parse_values(texts))
    return message


def messages_from_document(cls: type[M], text: str) -> Iterator[M]:
    """The messages in a text of YAML documents between lines of ``---``, or in lines of JSON.

    Raises:
        ValueMismatch: As ``message_from_values``, with the number of the line where the document
            starts. The messages before it have come out by then.
    """
    for document in parse_documents(text):
        message = cls()
        try:
            fill(message, document.value)
        except ValueMismatch as mismatch:
            raise ValueMismatch(f"line {document.line}: {mismatch.what}", mismatch.hint) from None
        yield message


def parse_values(texts: Sequence[str]) -> Value:
    """What the arguments of a command say, each parsed on its own: a value for ``fill``.

    Raises:
        ValueMismatch: The YAML is bad.
    """
    values = [_only_value(text) for text in texts]
    return values[0] if len(values) == 1 else values or {}


def parse_documents(text: str) -> Iterator[Document]:
    """The YAML documents of a text; empty ones are left out.

    Lines of JSON, which are no YAML without ``---`` between them, are documents too.

    Raises:
        ValueMismatch: The YAML is bad; the documents before it have come out by then.
    """
    lines = text.split("\n")
    if all(_JSON_LINE.fullmatch(line) for line in lines):
        for number, line in enumerate(lines, 1):
            yield from _parse(line, number)
    else:
        yield from _parse(text, 1)


def _parse(text: str, first_line: int) -> Iterator[Document]:
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
        raise _mismatch(bad, first_line) from None
    except yaml.MarkedYAMLError as error:
        found = BadYaml(error.problem_mark, str(error.problem))
        raise _mismatch(found, first_line, _colon_hint(found.problem, text)) from None
    except (yaml.reader.ReaderError, UnicodeEncodeError):
        raise _mismatch(_forbidden_character(text), first_line) from None


def _only_value(text: str) -> Value:
    documents = list(parse_documents(text))
    if len(documents) > 1:
        raise ValueMismatch(f"{len(documents)} YAML documents where one value is expected")
    return documents[0].value if documents else None


def _mismatch(bad: BadYaml, first_line: int, hint: str = "") -> ValueMismatch:
    mark = bad.mark
    place = f" at line {first_line + mark.line}, column {mark.column + 1}" if mark else ""
    return ValueMismatch(f"bad YAML{place}: {bad.problem}", hint)


def _forbidden_character(text: str) -> BadYaml:
    """What is wrong with a text that is not for YAML: control characters, half characters."""
    import yaml

    match = yaml.reader.Reader.NON_PRINTABLE.search(text)
    if not match:
        return BadYaml(None, "a character is not allowed")
    before = text[: match.start()]
    place = _Place(before.count("\n"), len(before) - before.rfind("\n") - 1)
    return BadYaml(place, f"the character U+{ord(match[0]):04X} is not allowed")


def _colon_hint(problem: str, text: str) -> str:
    """What to do about "x:1", if that is what broke the YAML."""
    match = re.search(r"\b([A-Za-z_]\w*):([^\s:/,}\]]+)", text)
    if not match or not problem.startswith(_COLON_PROBLEMS):
        return ""
    return f"put a space after the colon: '{match[1]}: {match[2]}'"


@dataclass(frozen=True, slots=True)
class _Place:
    """A place in the text, as a Mark; both count from 0."""

    line: int
    column: int
