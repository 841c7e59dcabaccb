"""A relay's report of all relays that it knows: its values and its encoding. Pure."""

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

from lcmtools.errors import DecodeError
from lcmtools.messages.appendable import Binding
from lcmtools.messages.codec import decode, encode
from lcmtools.types.lcmtools_msgs import Appendable, RelayEnd, RelayLink, RelayReport


class State(IntEnum):
    """A relay's state (the constants of lcmtools_msgs/RelayLink)."""

    ACTIVE = 0
    STANDBY = 1
    LEFT = 2


@dataclass(frozen=True, slots=True)
class End:
    """One end of a relay; the counts are since its start."""

    id: str
    bus: str = ""  # its name for people
    heard: tuple[str, ...] = ()  # ends whose reports arrive here
    ports: tuple[int, ...] = ()  # ports that it sends from
    is_up: bool = True
    trouble: str = ""
    messages: int = 0  # sent to this bus
    bytes: int = 0
    left_out: int = 0  # messages from this bus that were not passed on
    dropped: int = 0  # messages for this bus
    lost: int = 0  # messages from this bus that did not arrive
    commands: tuple[str, ...] = ()  # of this bus, not passed although the other's nodes wait


@dataclass(frozen=True, slots=True)
class Link:
    """A relay as it reports itself."""

    id: str
    name: str
    host: str
    ends: tuple[End, End]
    state: State = State.STANDBY
    number: int = 0  # number of its latest report


class Report(NamedTuple):
    """Everything that a relay knows of relays, itself first."""

    end: str  # the id of the end that sends this
    links: tuple[Link, ...]


def encode_report(report: Report) -> bytes:
    """Return the payload of a report."""
    return encode(RelayReport(end=report.end, links=_LINK.appendables(report.links)))


def decode_report(payload: bytes) -> Report | None:
    """Return the report in a payload, without links that cannot be read; None if there is none."""
    try:
        message = decode(RelayReport, payload)
    except DecodeError:
        return None
    links = []
    for one in message.links:
        with suppress(DecodeError, ValueError):
            links.append(_LINK.decode(one.data))
    return Report(message.end, tuple(links))


def _state(number: int) -> State:
    return State(number) if number in set(State) else State.STANDBY


def _both(ends: Iterable[Appendable]) -> tuple[End, End]:
    here, there = _END.all(ends)
    return here, there


_END = Binding(RelayEnd, End)
_LINK = Binding(RelayLink, Link, state=(int, _state), ends=(_END.appendables, _both))
