"""A relay's report of all relays that it knows: its values and its encoding. Pure."""

from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

from lcmtools.errors import DecodeError
from lcmtools.messages.appendable import appendables, decode_appendable
from lcmtools.messages.codec import decode, encode
from lcmtools.types.lcmtools_msgs import RelayEnd, RelayLink, RelayReport

_ENDS = 2


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


class Knowledge(NamedTuple):
    """Everything that a relay knows of relays, itself first."""

    end: str  # the id of the end that sends this
    links: tuple[Link, ...]


def encode_report(report: Knowledge) -> bytes:
    """Return the payload of a report."""
    message = RelayReport()
    message.end = report.end
    message.links = appendables(map(_link_message, report.links))
    return encode(message)


def decode_report(payload: bytes) -> Knowledge | None:
    """Return the report in a payload, without links that cannot be read; None if there is none."""
    try:
        message = decode(RelayReport, payload)
    except DecodeError:
        return None
    return Knowledge(message.end, tuple(link for one in message.links if (link := _link(one.data))))


_OF_END = ("id", "bus", "is_up", "trouble", "messages", "bytes", "left_out", "dropped", "lost")
_LISTS_OF_END = ("heard", "ports", "commands")
_STATES = frozenset(State)


def _link_message(link: Link) -> RelayLink:
    message = RelayLink()
    message.id, message.name, message.host = link.id, link.name, link.host
    message.state, message.number = link.state, link.number
    message.ends = appendables(map(_end_message, link.ends))
    return message


def _end_message(end: End) -> RelayEnd:
    message = RelayEnd()
    for name in _OF_END:
        setattr(message, name, getattr(end, name))
    for name in _LISTS_OF_END:
        setattr(message, name, list(getattr(end, name)))
    return message


def _link(data: bytes) -> Link | None:
    try:
        message = decode_appendable(RelayLink, data)
        ends = [_end(decode_appendable(RelayEnd, end.data)) for end in message.ends]
    except DecodeError:
        return None
    if len(ends) != _ENDS:
        return None
    state = State(message.state) if message.state in _STATES else State.STANDBY
    return Link(message.id, message.name, message.host, (ends[0], ends[1]), state, message.number)


def _end(message: RelayEnd) -> End:
    known = {name: getattr(message, name) for name in _OF_END}
    known |= {name: tuple(getattr(message, name)) for name in _LISTS_OF_END}
    return End(**known)
