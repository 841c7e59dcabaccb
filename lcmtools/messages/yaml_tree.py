"""A YAML document as plain values, made event by event.

Belongs here: nesting, keys, anchors and tags. Must not know messages. The YAML library's own
loaders are not used, because they crash (a segmentation fault) on deep nesting, follow aliases
without end, take the last of several equal keys and forget what was quoted.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from lcmtools.messages.plain import Value

if TYPE_CHECKING:
    import yaml

DEEPEST = 100
"""Levels of nesting; far more than any message has."""
MOST_REPEATED = 100_000
"""Values that aliases may repeat in a document, so that a line of text cannot fill the memory."""

_TAG = "tag:yaml.org,2002:"
_NULLS = ("", "~", "null", "Null", "NULL")
_COLLECTION_TAGS = (None, "!", f"{_TAG}seq", f"{_TAG}map")
_TEXT_TAGS = (None, *(f"{_TAG}{name}" for name in ("int", "float", "bool", "null", "timestamp")))


class Mark(Protocol):
    """A place in the text, as the YAML library has it; both count from 0."""

    @property
    def line(self) -> int:
        """The line."""

    @property
    def column(self) -> int:
        """The character in it."""


class BadYaml(ValueError):  # noqa: N818 - named for what happened, as in errors.py
    """YAML, but none that a message can be filled from.

    Attributes:
        mark: Where.
        problem: What is wrong there.
        hint: What to type instead, or "".
    """

    def __init__(self, mark: Mark | None, problem: str, hint: str = "") -> None:
        super().__init__(problem)
        self.mark = mark
        self.problem = problem
        self.hint = hint


@dataclass(slots=True)
class _Open:
    """A list or a mapping whose end has not come yet."""

    value: list[Value] | dict[str, Value]
    anchor: str | None
    key: str | None = None
    weight: int = 1

    def add(self, value: Value, weight: int) -> None:
        self.weight += weight
        if isinstance(self.value, list):
            self.value.append(value)
        elif self.key is not None:
            self.value[self.key] = value
            self.key = None


class Tree:
    """The value of one document while its events come in.

    Attributes:
        root: The value, once they all have; None for an empty document.
        line: The number of the line where it starts, from 0.
    """

    def __init__(self) -> None:
        self.root: Value = None
        self.line = 0
        self._open: list[_Open] = []
        self._anchors: dict[str, tuple[Value, int]] = {}
        self._repeated = 0

    def take(self, event: "yaml.Event") -> None:
        """Take the next event.

        Raises:
            BadYaml: No message can be filled from it.
        """
        import yaml

        if isinstance(event, yaml.ScalarEvent):
            self._take_scalar(event)
        elif isinstance(event, yaml.CollectionStartEvent):
            self._start(event, [] if isinstance(event, yaml.SequenceStartEvent) else {})
        elif isinstance(event, yaml.CollectionEndEvent):
            done = self._open.pop()
            self._add(done.value, done.weight, done.anchor)
        elif isinstance(event, yaml.AliasEvent):
            self._take_alias(event)

    def _take_scalar(self, event: "yaml.ScalarEvent") -> None:
        if self._wants_key():
            self._set_key(event.value, event)
        else:
            self._note_line(event)
            self._add(_scalar(event), 1, event.anchor)

    def _start(
        self, event: "yaml.CollectionStartEvent", value: list[Value] | dict[str, Value]
    ) -> None:
        self._note_line(event)
        if self._wants_key():
            raise BadYaml(event.start_mark, "a field's name must be a word", _quote("{{"))
        if len(self._open) == DEEPEST:
            raise BadYaml(event.start_mark, f"nested more than {DEEPEST} levels deep")
        if event.tag not in _COLLECTION_TAGS:
            raise _unknown_tag(event)
        self._open.append(_Open(value, event.anchor))

    def _take_alias(self, event: "yaml.AliasEvent") -> None:
        if event.anchor not in self._anchors:
            raise BadYaml(event.start_mark, f"unknown alias '*{event.anchor}'", _quote("*"))
        value, weight = self._anchors[event.anchor]
        self._repeated += weight
        if self._repeated > MOST_REPEATED:
            raise BadYaml(event.start_mark, f"aliases repeat more than {MOST_REPEATED} values")
        if self._wants_key():
            self._set_key(value, event)
        else:
            self._add(value, weight, None)

    def _wants_key(self) -> bool:
        return (
            bool(self._open)
            and isinstance(self._open[-1].value, dict)
            and self._open[-1].key is None
        )

    def _set_key(self, key: Value, event: "yaml.NodeEvent") -> None:
        mapping = self._open[-1]
        if not isinstance(key, str):
            raise BadYaml(event.start_mark, "a field's name must be a word")
        if key in mapping.value:
            raise BadYaml(event.start_mark, f"'{key}' is given twice")
        mapping.key = key

    def _add(self, value: Value, weight: int, anchor: str | None) -> None:
        if anchor:
            self._anchors[anchor] = (value, weight)
        if self._open:
            self._open[-1].add(value, weight)
        else:
            self.root = value

    def _note_line(self, event: "yaml.NodeEvent") -> None:
        if not self._open and event.start_mark:
            self.line = event.start_mark.line


def _scalar(event: "yaml.ScalarEvent") -> Value:
    """Text; None for a null that is not quoted; bytes for !!binary."""
    text: str = event.value
    plain = event.implicit[0]
    if plain or event.tag in _TEXT_TAGS:
        unquoted = plain or event.tag is not None
        return None if unquoted and text in _NULLS else text
    if event.tag in ("!", f"{_TAG}str"):
        return text
    if event.tag == f"{_TAG}binary":
        return _binary(event)
    raise _unknown_tag(event)


def _binary(event: "yaml.ScalarEvent") -> bytes:
    from base64 import b64decode, b64encode

    text = "".join(event.value.split())
    try:
        data = b64decode(text, validate=True)
    except ValueError:
        data = b""
    if b64encode(data) != text.encode():  # some Pythons take "=" for base64
        raise BadYaml(event.start_mark, "!!binary is not followed by base64")
    return data


def _unknown_tag(event: "yaml.ScalarEvent | yaml.CollectionStartEvent") -> BadYaml:
    tag = str(event.tag).replace(_TAG, "!!")
    return BadYaml(event.start_mark, f"the tag {tag} means nothing here", _quote("!"))


def _quote(start: str) -> str:
    return f"put text that begins with '{start}' in quotes"
