"""The protocol between a page and the server: incoming requests and outgoing frames.

A page sends JSON texts with an ``op``, and the server answers with the same ``id``:

    {"op": "open", "id": 7, "stream": "topics", ...}    updates follow until it is closed; with the
                                                        id of an open one: in place of that
    {"op": "took", "id": 7}                             if it was opened with "paced": true, the
                                                        next update follows only after this
    {"op": "close", "id": 7}
    {"op": "ask", "id": 9, "what": "type", ...}         one answer
    {"op": "do", "id": 11, "what": "publish", ...}      one answer; needs the right to command

Each has the time ``sent`` [s] by the page's clock. Other values of ``op`` are in ``page``.

The server sends JSON texts, and for many numbers binary frames: the length of a JSON header
(uint32), the header, padded with spaces so that the payload begins at a multiple of eight bytes,
and the payload. All numbers are little-endian. Numbers that JSON lacks are the texts "nan", "inf"
and "-inf", as in ``--json``; null is a missing value.

Sans-I/O. Must not know the content of streams.
"""

import json
import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias, TypeVar

from lcmtools.errors import LcmtoolsError
from lcmtools.formats.strict_json import write_json
from lcmtools.formats.typed import Item, Within, arguments, read

if TYPE_CHECKING:
    from typing_extensions import Self

Json: TypeAlias = "bool | int | float | str | Sequence[Json] | Mapping[str, Json] | None"
Frame: TypeAlias = str | bytes
Number = TypeVar("Number", int, float)
T = TypeVar("T")

SUBPROTOCOL = "lcmtools.1"
LONGEST_REQUEST = 1 << 20  # bytes of a text that a page may send, such as a form with long arrays
_LONGEST_TEXT = 1000  # characters of a name
_MOST_TEXTS = 1000  # names in a list
_HEAD = ("op", "id", "sent", "stream", "what", "paced")
_ALIGNMENT = 8


class MalformedRequest(LcmtoolsError):  # noqa: N818 - named for what happened, as in errors.py
    """A page has sent data that no page of this server would."""


@dataclass(frozen=True, slots=True)
class JsonItem(Item):
    """A value of a request; ``node`` is the value itself. Readers raise MalformedRequest.

    A key with null is as if it were not there.
    """

    name: str = "request"
    source: str = ""
    node: Json = None

    @property
    def content(self) -> object:
        """The value."""
        return self.node

    def error(self, reason: str, hint: str = "") -> LcmtoolsError:
        """Return the error for this value, to be raised by the caller."""
        return MalformedRequest(reason[:_LONGEST_TEXT], hint[:_LONGEST_TEXT])

    def text(self) -> str:
        """Return a name or another short text."""
        if not isinstance(self.node, str) or len(self.node) > _LONGEST_TEXT:
            raise self.error(f"'{self.name}' is not a short text")
        return self.node

    def flag(self) -> bool:
        """Return true or false."""
        if not isinstance(self.node, bool):
            raise self.error(f"'{self.name}' is neither true nor false")
        return self.node

    def parsed(self, parse: Callable[[str], Number], kind: str) -> Number:
        """Return a number."""
        if isinstance(self.node, bool) or not isinstance(self.node, (int, float)):
            raise self.error(f"'{self.name}' must be {kind}")
        return super(JsonItem, replace(self, node=str(self.node))).parsed(parse, kind)

    def items(self, *lengths: int) -> list["Self"]:
        """Return the elements of a short list."""
        found = super(JsonItem, self).items(*lengths)
        if len(found) > _MOST_TEXTS:
            raise self.error(f"'{self.name}' is not a short list")
        return found

    def _mapping(self) -> dict[str, object]:
        found = super(JsonItem, self)._mapping()
        return {name: value for name, value in found.items() if value is not None}

    def _key(self, written: str, _: object) -> "Self":
        return replace(self, name="key", node=written)


@dataclass(frozen=True, slots=True)
class PageRequest:
    """One request of a page; which of the names it has depends on its operation."""

    op: str
    id: Annotated[int, Within(0, 1 << 31)]  # the number that the page has assigned to it
    sent: float | None = None  # by the page's own clock [s]
    stream: str = ""  # that is opened
    what: str = ""  # is asked or done
    paced: bool = False
    values: Mapping[str, Json] = field(default_factory=dict)  # all others

    def read(self, make: Callable[..., T]) -> T:
        """Return a dataclass or a function's result with the values; see ``arguments``."""
        return make(**self.arguments(make))

    def arguments(self, make: Callable[..., object]) -> dict[str, Any]:
        """Return the values as arguments of a function; MalformedRequest for unexpected ones."""
        return json_arguments(make, self.values)


def json_arguments(make: Callable[..., object], values: Mapping[str, Json]) -> dict[str, Any]:
    """Return values as keyword arguments of a function; MalformedRequest for unexpected ones."""
    (found,) = arguments(JsonItem(node=values), make)
    return found


def read_request(data: str | bytes) -> PageRequest:
    """Return the request in a WebSocket message; MalformedRequest if it is none."""
    if isinstance(data, bytes):
        raise MalformedRequest("it sent bytes")
    try:
        values = json.loads(data, parse_constant=_refuse)
    except (ValueError, RecursionError):
        raise MalformedRequest("it sent what is not JSON") from None
    if not isinstance(values, dict):
        raise MalformedRequest("it sent JSON that is not an object")
    head = {name: values.pop(name) for name in _HEAD if name in values}
    return replace(read(PageRequest, JsonItem(node=head)), values=values)


def _refuse(constant: str) -> None:
    raise ValueError(constant)


def text_frame(values: Mapping[str, Json]) -> str:
    """Return a text for a page."""
    return write_json(values)


def binary_frame(header: Mapping[str, Json], payload: bytes | memoryview) -> bytes:
    """Return a binary frame for a page."""
    text = text_frame(header).encode()
    text += b" " * (-(4 + len(text)) % _ALIGNMENT)
    return b"".join((struct.pack("<I", len(text)), text, payload))
