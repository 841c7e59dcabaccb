"""YAML parsed strictly, event by event, into nodes with line numbers.

Belongs here: nesting, keys, anchors and tags. Scalars stay text, because only the reader of a value
knows its type: ``1e3`` may be a number and ``no`` a name. PyYAML's own loaders are not used: they
crash (a segmentation fault) on deep nesting, follow aliases without a limit, keep the last of
several equal keys, and do not report which scalars were quoted.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING, TypeAlias, cast

from lcmtools.errors import InvalidFile
from lcmtools.formats.yaml_problem import (
    DEEPEST,
    TOO_DEEP,
    BadYaml,
    explained,
    forbidden_character,
    quote_hint,
)

if TYPE_CHECKING:
    import yaml

MOST_REPEATED = 100_000
"""The most values that a document's aliases may repeat: one line could exhaust the memory."""

PlainNode: TypeAlias = "str | bytes | list[PlainNode] | dict[str, PlainNode] | None"

_TAG = "tag:yaml.org,2002:"
_NULLS = ("", "~", "null", "Null", "NULL")
_COLLECTION_TAGS = (None, "!", f"{_TAG}seq", f"{_TAG}map")
_TEXT_TAGS = (None, *(f"{_TAG}{name}" for name in ("int", "float", "bool", "null", "timestamp")))


class QuotedText(str):
    """Text in quotes, which is no number, truth value or null, whatever it says."""

    __slots__ = ()


class YamlNode:
    """A value in a document, with its line."""

    __slots__ = ("is_quoted", "key_line", "line", "value")

    def __init__(
        self,
        value: "str | bytes | list[YamlNode] | dict[str, YamlNode]",
        line: int = 1,
        *,
        is_quoted: bool = False,
    ) -> None:
        self.value = value  # text as written, bytes (!!binary), a list, or a mapping
        self.line = line  # where it begins, from 1
        self.key_line = line  # the line of its key in a mapping
        self.is_quoted = is_quoted  # True for text in quotes, in a block, or tagged !!str

    @property
    def is_nothing(self) -> bool:
        """True for an unquoted empty value, ``~`` or ``null``."""
        return not self.is_quoted and isinstance(self.value, str) and self.value in _NULLS

    def plain(self) -> PlainNode:
        """Return the value without line numbers; None for an empty one, QuotedText in quotes."""
        value = self.value
        if isinstance(value, str):
            return QuotedText(value) if self.is_quoted else None if value in _NULLS else value
        if isinstance(value, list):
            return [node.plain() for node in value]
        if isinstance(value, dict):
            return {key: node.plain() for key, node in value.items()}
        return value


def read_values(text: str) -> Iterator[tuple[PlainNode, int]]:
    """Yield the value and the first line of each document that is not empty."""
    for root in read_documents(text, keeps_places=False):
        if root:
            yield _bare(root), root.line


def read_documents(
    text: str, *, keeps_places: bool = True, merges_keys: bool = False
) -> Iterator[YamlNode | None]:
    """Yield the documents in a text; None for an empty one.

    If ``keeps_places`` is False, only the root is a Node: in a large text the garbage collector
    would visit all other nodes again and again. BadYaml is raised for an invalid document, after
    the documents before it.
    """
    import yaml

    loader = getattr(yaml, "CBaseLoader", yaml.BaseLoader)
    tree = _Tree(keeps_places=keeps_places, merges_keys=merges_keys)
    try:
        for event in yaml.parse(text, Loader=loader):
            tree.add_event(event)
            if isinstance(event, yaml.DocumentEndEvent):
                yield tree.root
                tree = _Tree(keeps_places=keeps_places, merges_keys=merges_keys)
    except yaml.MarkedYAMLError as error:
        raise explained(error, text) from None
    except (yaml.reader.ReaderError, UnicodeEncodeError):
        raise forbidden_character(text) from None


def read_file(text: str, source: str, *, merges_keys: bool = False) -> YamlNode | None:
    """Return a file's only document, None if it is empty; raise InvalidFile with the line.

    With ``merges_keys``, "<<" merges mappings and the last of several equal keys counts, as in
    PyYAML.
    """
    try:
        found = [node for node in read_documents(text, merges_keys=merges_keys) if node]
    except BadYaml as bad:
        raise InvalidFile(f"{source}:{bad.line or 1}: not YAML: {bad.problem}", bad.hint) from None
    if len(found) > 1:
        reason = "another document begins, but only one is expected"
        raise InvalidFile(f"{source}:{found[1].line}: {reason}", "remove the --- line")
    return found[0] if found else None


_Key: TypeAlias = "tuple[str, int]"
_NO_KEY: _Key = ("", 0)  # for the root and the values in a list
_MERGE_KEY: _Key = ("<<", 0)  # for mappings whose keys are merged into the one around them


class _Tree:
    """Builds the nodes of one document from its events."""

    def __init__(self, *, keeps_places: bool, merges_keys: bool) -> None:
        import yaml

        self._yaml = yaml
        self._keeps_places = keeps_places
        self._merges_keys = merges_keys
        self.root: YamlNode | None = None
        self._open: list[tuple[YamlNode, str | None]] = []  # collections, each with its anchor
        self._keys: list[_Key | None] = [_NO_KEY]  # of the next value; None: a key is next
        self._merged: list[dict[str, YamlNode]] = []  # of each open collection
        self._anchors: dict[str, YamlNode] = {}
        self._repeated = 0

    def add_event(self, event: "yaml.Event") -> None:
        """Add the next event; raise BadYaml if it is not allowed there."""
        yaml = self._yaml
        if isinstance(event, yaml.ScalarEvent):
            if self._keys[-1] is None:
                self._set_key(event, event.value)
            else:
                self._add(_scalar(event), event.anchor)
        elif isinstance(event, yaml.CollectionStartEvent):
            self._start(event, is_list=isinstance(event, yaml.SequenceStartEvent))
        elif isinstance(event, yaml.CollectionEndEvent):
            self._keys.pop()
            node, anchor = self._open.pop()
            if merged := self._merged.pop():
                node.value = {**merged, **cast("dict[str, YamlNode]", node.value)}
            self._add(node, anchor)
        elif isinstance(event, yaml.AliasEvent):
            self._add_alias(event)

    def _start(self, event: "yaml.CollectionStartEvent", *, is_list: bool) -> None:
        if self._keys[-1] is None:
            raise _bad(event, "a key must be a word", quote_hint("{{"))
        if len(self._open) == DEEPEST:
            raise _bad(event, TOO_DEEP)
        if event.tag not in _COLLECTION_TAGS:
            raise _unknown_tag(event)
        self._open.append((YamlNode([] if is_list else {}, _line(event)), event.anchor))
        self._keys.append(_NO_KEY if is_list else None)
        self._merged.append({})

    def _add_alias(self, event: "yaml.AliasEvent") -> None:
        known = self._anchors.get(event.anchor or "")
        if known is None:
            raise _bad(event, f"unknown alias '*{event.anchor}'", quote_hint("*"))
        self._repeated += _count(known)
        if self._repeated > MOST_REPEATED:
            raise _bad(event, f"aliases repeat more than {MOST_REPEATED} values")
        if self._keys[-1] is None:
            self._set_key(event, _bare(known))
        else:
            self._add(YamlNode(known.value, known.line, is_quoted=known.is_quoted), None)

    def _set_key(self, event: "yaml.NodeEvent", key: object) -> None:
        if not isinstance(key, str):
            raise _bad(event, "a key must be a word")
        mapping = self._open[-1][0].value
        assert isinstance(mapping, dict)
        if key in mapping and not self._merges_keys:
            raise _bad(event, f"'{key}' is given twice", "leave one of them out")
        if key == "<<" and not self._merges_keys:
            raise _bad(event, "'<<' cannot merge other keys here", "write them out")
        is_merge = key == "<<" and getattr(event, "implicit", (False,))[0]
        self._keys[-1] = _MERGE_KEY if is_merge else (key, _line(event))

    def _add(self, node: YamlNode, anchor: str | None) -> None:
        if anchor:
            self._anchors[anchor] = node
        if not self._open:
            self.root = None if node.is_nothing else node
            return
        value, key = self._open[-1][0].value, self._keys[-1]
        part = node if self._keeps_places else cast("YamlNode", _bare(node))
        if isinstance(value, list):
            value.append(part)
        elif key is _MERGE_KEY:
            self._merge(node)
            self._keys[-1] = None
        elif key and isinstance(value, dict):
            value[key[0]], node.key_line = part, key[1]
            self._keys[-1] = None

    def _merge(self, node: YamlNode) -> None:
        """Merge a mapping, or a list of them of which the first ones take precedence."""
        parts = node.value if isinstance(node.value, list) else [node]
        for part in reversed(parts):
            if not isinstance(part.value, dict):
                problem = "'<<' merges mappings only"
                raise BadYaml(problem, node.line, hint="write  <<: *NAME  for one with &NAME")
            self._merged[-1].update(part.value)


def _bare(node: YamlNode) -> PlainNode:
    """Return the value of a node whose parts are converted already; None for an empty one."""
    return None if node.is_nothing else cast("PlainNode", node.value)


def _count(part: object) -> int:
    """Count the values in a part, repeated ones each time."""
    value = part.value if isinstance(part, YamlNode) else part
    if isinstance(value, dict):
        return 1 + sum(map(_count, value.values()))
    return 1 + sum(map(_count, value)) if isinstance(value, list) else 1


def _scalar(event: "yaml.ScalarEvent") -> YamlNode:
    plain = event.implicit[0]
    if plain or event.tag in _TEXT_TAGS:
        return YamlNode(event.value, _line(event), is_quoted=not plain and event.tag is None)
    if event.tag in ("!", f"{_TAG}str"):
        return YamlNode(event.value, _line(event), is_quoted=True)
    if event.tag == f"{_TAG}binary":
        return YamlNode(_binary(event), _line(event))
    raise _unknown_tag(event)


def _binary(event: "yaml.ScalarEvent") -> bytes:
    from base64 import b64decode, b64encode

    text = "".join(event.value.split())
    try:
        data = b64decode(text, validate=True)
    except ValueError:
        data = b""
    if b64encode(data) != text.encode():  # some versions of Python accept "=" as base64
        raise _bad(event, "!!binary is not followed by base64")
    return data


def _line(event: "yaml.NodeEvent") -> int:
    mark = event.start_mark
    return mark.line + 1 if mark else 1


def _bad(event: "yaml.Event", problem: str, hint: str = "") -> BadYaml:
    return BadYaml.at(cast("yaml.Mark | None", event.start_mark), problem, hint)


def _unknown_tag(event: "yaml.ScalarEvent | yaml.CollectionStartEvent") -> BadYaml:
    tag = str(event.tag).replace(_TAG, "!!")
    return _bad(event, f"the tag {tag} is not supported here", quote_hint("!"))
