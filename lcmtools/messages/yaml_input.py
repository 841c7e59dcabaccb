"""Messages from the YAML that users type: arguments, as ``rostopic pub`` takes them, and texts.

Belongs here: the forms of YAML that are accepted, and the errors for others. Must not know the
source of the text. Every scalar stays text until a field's type decides (see ``fill``), so that
``1e-3`` is a number and ``on`` a word wherever one is wanted.
"""

from collections.abc import Iterable, Iterator, Sequence
from typing import TypeVar

from lcmtools.errors import ValueMismatch
from lcmtools.messages.documents import Document, Documents, parse
from lcmtools.messages.fields import visible_fields
from lcmtools.messages.fill import Value, fill
from lcmtools.messages.message_template import MessageTemplate, draft
from lcmtools.messages.registry import Message

M = TypeVar("M", bound=Message)


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


def draft_from_values(cls: type[M], texts: Sequence[str]) -> MessageTemplate[M]:
    """As ``message_from_values``; times may be ``now`` and headers ``auto``.

    Raises:
        ValueMismatch: The YAML is bad, or a value does not fit the field that it names.
    """
    value = parse_values(texts)
    try:
        return draft(cls, value)
    except ValueMismatch as mismatch:
        hint = mismatch.hint or _arguments_hint(cls, texts, value)
        raise ValueMismatch(mismatch.what, hint) from None


def drafts_from_lines(
    cls: type[M], lines: Iterable[str | None]
) -> Iterator[MessageTemplate[M] | None]:
    """The messages in a text of YAML documents between lines of ``---``, or of JSON.

    Args:
        cls: The messages' class.
        lines: The text's lines as they come; None where none has come for a while, which is
            yielded too.

    Raises:
        ValueMismatch: As ``draft_from_values``, with the number of the document and of the line.
            The messages before it have come out by then.
    """
    documents = Documents()
    for line in lines:
        if line is None:
            yield None
        else:
            yield from _drafts(cls, documents, documents.take(line))
    yield from _drafts(cls, documents, documents.end())


def parse_values(texts: Sequence[str]) -> Value:
    """The arguments of a command, each parsed on its own, as a value for ``fill``.

    Raises:
        ValueMismatch: The YAML is bad.
    """
    values = [_only_value(text) for text in texts]
    return values[0] if len(values) == 1 else values or {}


def _drafts(
    cls: type[M], documents: Documents, found: Iterator[Document]
) -> Iterator[MessageTemplate[M]]:
    where = ""
    try:
        for document in found:
            where = f", line {document.line}"
            yield draft(cls, document.value)
            where = ""
    except ValueMismatch as mismatch:
        what = f"document {documents.count}{where}: {mismatch.what}"
        raise ValueMismatch(what, mismatch.hint) from None


def _only_value(text: str) -> Value:
    documents = list(parse(text))
    if len(documents) > 1:
        raise ValueMismatch(f"{len(documents)} YAML documents where one value is expected")
    return documents[0].value if documents else None


def _arguments_hint(cls: type[Message], texts: Sequence[str], value: Value) -> str:
    """A hint at words and fields that the shell has split."""
    if len(texts) < 2 or not isinstance(value, list):  # noqa: PLR2004 - what can be taken apart
        return ""
    names = {field.name for field in visible_fields(cls)}
    if all(_names_a_field(part, names) for part in value):
        return "write all fields into one argument: '{name: value, name: value}'"
    fields = visible_fields(cls)
    if len(fields) == 1 and fields[0].type == "string":
        return f"put the text in quotes: '{' '.join(texts)}'"
    return ""


def _names_a_field(part: Value, names: set[str]) -> bool:
    """Return True for an argument "x: 1", and for its misspelling "x:1"."""
    if isinstance(part, dict):
        return bool(part) and names.issuperset(part)
    return isinstance(part, str) and part.partition(":")[0] in names
