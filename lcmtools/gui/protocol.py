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
import math
import struct
import sys
from collections.abc import Mapping, Sequence
from typing import TypeAlias, cast

from lcmtools.errors import LcmtoolsError
from lcmtools.formats.strict_json import write_json

Json: TypeAlias = "bool | int | float | str | Sequence[Json] | Mapping[str, Json] | None"
Frame: TypeAlias = str | bytes

SUBPROTOCOL = "lcmtools.1"
LONGEST_REQUEST = 1 << 20  # bytes of a text that a page may send, such as a form with long arrays
_LONGEST_TEXT = 1000  # characters of a name
_MOST_TEXTS = 1000  # names in a list
_LARGEST_ID = 1 << 31
_ALIGNMENT = 8


class MalformedRequest(LcmtoolsError):  # noqa: N818 - named for what happened, as in errors.py
    """A page has sent data that no page of this server would."""


class Parameters:
    """The values of a request; every method raises MalformedRequest for an unexpected one."""

    def __init__(self, values: Mapping[str, Json]) -> None:
        self._values = values

    @property
    def key(self) -> str:
        """A text that is the same for equal parameters."""
        return json.dumps(self._values, sort_keys=True)

    def text(self, name: str, default: str | None = None) -> str:
        """Return a name or another short text."""
        value = self._get(name, default)
        if not isinstance(value, str) or len(value) > _LONGEST_TEXT:
            raise MalformedRequest(f"'{name}' is not a short text")
        return value

    def texts(self, name: str) -> tuple[str, ...]:
        """Return a list of short texts; empty if there is none."""
        value = self._get(name, [])
        if not isinstance(value, list) or len(value) > _MOST_TEXTS:
            raise MalformedRequest(f"'{name}' is not a short list")
        return tuple(Parameters({name: one}).text(name) for one in value)

    def number(
        self,
        name: str,
        default: float | None = None,
        lowest: float = -math.inf,
        highest: float = math.inf,
    ) -> float:
        """Return a finite number within bounds."""
        value = self._get(name, default)
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise MalformedRequest(f"'{name}' is not a number")
        if not (abs(value) <= sys.float_info.max and lowest <= value <= highest):
            raise MalformedRequest(f"'{name}' is not within {lowest:g} to {highest:g}")
        return float(value)

    def flag(self, name: str, *, default: bool = False) -> bool:
        """Return true or false."""
        value = self._get(name, default)
        if not isinstance(value, bool):
            raise MalformedRequest(f"'{name}' is neither true nor false")
        return value

    def value(self, name: str) -> Json:
        """Return a value of any kind; None if there is none."""
        return self._values.get(name)

    def without(self, *names: str) -> "Parameters":
        """Return the other values."""
        return Parameters({name: v for name, v in self._values.items() if name not in names})

    def with_text(self, name: str, text: str) -> "Parameters":
        """Return all values, with another text."""
        return Parameters({**self._values, name: text})

    def _get(self, name: str, default: Json) -> Json:
        value = self._values.get(name, default)
        if value is None:
            raise MalformedRequest(f"'{name}' is missing")
        return value


class PageRequest(Parameters):
    """One request of a page, with its operation, its number, and the time when it was sent.

    ``sent`` is by the page's own clock [s]; None if it does not say it.
    """

    def __init__(self, values: Mapping[str, Json]) -> None:
        super().__init__({name: value for name, value in values.items() if name != "sent"})
        self.op = self.text("op")
        self.sent = Parameters(values).number("sent") if "sent" in values else None

    @property
    def id(self) -> int:
        """The number that the page has assigned to it."""
        return int(self.number("id", None, 0, _LARGEST_ID))


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
    return PageRequest(cast("dict[str, Json]", values))


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
