"""Messages from YAML that users write: arguments, as for ``rostopic pub``, and texts.

Belongs here: the accepted forms of YAML, and the errors for others. Must not know the source of the
text, nor read a clock: the time of sending comes in as an argument. Every scalar stays text until a
field's type decides (see ``fill``): ``1e-3`` is a number for a number field, and ``on`` a word for
a string.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from lcmtools.errors import ValueMismatch
from lcmtools.messages.codec import encode
from lcmtools.messages.documents import Document, Documents, parse_values
from lcmtools.messages.fields import fields, visible_fields
from lcmtools.messages.fill import SetTime, Value, fill
from lcmtools.messages.registry import Message

M = TypeVar("M", bound=Message)


@dataclass(slots=True)
class MessageTemplate(Generic[M]):
    """A message that is ready to be sent, once or often."""

    message: M
    times: tuple[SetTime, ...] = ()  # of the times in it that are set whenever it is sent
    _payload: bytes | None = None

    def at(self, now: int) -> M:
        """Return the message as sent at ``now`` [ns since 1970]."""
        for set_time in self.times:
            set_time(now)
        return self.message

    def payload(self, now: int) -> bytes:
        """Return the same, encoded; ValueMismatch if a value, such as a time, is out of range."""
        if self.times:
            return encode(self.at(now))
        if self._payload is None:
            self._payload = encode(self.message)
        return self._payload


def draft(cls: type[M], value: Value) -> MessageTemplate[M]:
    """Return the message for a value; ValueMismatch if a field does not fit: see ``fill``."""
    message = cls()
    return MessageTemplate(message, fill(message, value))


def draft_from_values(cls: type[M], texts: Sequence[str]) -> MessageTemplate[M]:
    """Return the message for a user's arguments; fields that are not named have defaults.

    Args:
        cls: The message's class.
        texts: Each is YAML. Together they are: nothing; one mapping of fields; one list of all
            fields in order; all fields in order, one text each; or one value for the only field of
            a message.

    Raises:
        ValueMismatch: The YAML is invalid, or a value does not fit its field.
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
    """Yield the messages in a text: YAML documents between lines of ``---``, or JSON.

    Args:
        cls: The messages' class.
        lines: The text's lines as they come; None if none has come for a while, which yields None
            too.

    Raises:
        ValueMismatch: As in ``draft_from_values``, with the numbers of the document and the line.
            The messages before it have been yielded by then.
    """
    documents = Documents(keeps_empty=not visible_fields(cls))
    for line in lines:
        if line is None:
            yield None
        else:
            yield from _drafts(cls, documents, documents.add_line(line))
    yield from _drafts(cls, documents, documents.end())


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


def _arguments_hint(cls: type[Message], texts: Sequence[str], value: Value) -> str:
    """Return a hint about words and fields that the shell has split."""
    if len(texts) < 2 or not isinstance(value, list):  # noqa: PLR2004 - one text is not split
        return ""
    names = {field.name for field in fields(cls)}
    if all(_names_a_field(part, names) for part in value):
        return "write all fields into one argument: '{name: value, name: value}'"
    targets = visible_fields(cls)
    if len(targets) == 1 and targets[0].type == "string":
        return f"put the text in quotes: '{' '.join(texts)}'"
    return ""


def _names_a_field(part: Value, names: set[str]) -> bool:
    """Return True for an argument "x: 1", and for its misspelling "x:1"."""
    if isinstance(part, dict):
        return bool(part) and names.issuperset(part)
    return isinstance(part, str) and part.partition(":")[0] in names
