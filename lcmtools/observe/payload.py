"""What a packet's payload says: decoded by the topic's type where that is known."""

from lcmtools.errors import DecodeError
from lcmtools.messages.codec import decode
from lcmtools.messages.registry import (
    Message,
    candidates,
    fingerprint,
    message_class,
    problems,
    type_name,
)
from lcmtools.observe.monitor import BusMonitor
from lcmtools.packages.type_files import VARIABLE
from lcmtools.wire.packet import Packet

_SHOWN_BYTES = 64
UNKNOWN = "unknown type"


class Decoder:
    """Turns packets into messages.

    Two types with the same fields have the same fingerprint: the person, or else a node's
    announcement, settles which one is meant; else the likeliest is taken.

    Args:
        monitor: The bus.
        said: The type that the messages are said to be of.
    """

    def __init__(self, monitor: BusMonitor, said: type[Message] | None = None) -> None:
        self._monitor = monitor
        self._said = said
        self._classes: dict[tuple[str, int], type[Message]] = {}

    def decode(self, packet: Packet) -> Message | str:
        """The message, or why there is none."""
        if packet.fingerprint is None:
            return "too short for an LCM message"
        kind = self._class(packet.channel, packet.fingerprint)
        if isinstance(kind, str):
            return kind
        try:
            return decode(kind, packet.payload, keep_stray=True)
        except DecodeError as error:
            return str(error)

    def _class(self, channel: str, number: int) -> type[Message] | str:
        if self._said is not None:
            return self._said if fingerprint(self._said) == number else self._not_as_said(number)
        key = (channel, number)
        if key not in self._classes:
            names = candidates(number)
            if not names:
                return f"{UNKNOWN}, fingerprint {number:#018x}"
            announced = self._monitor.graph().topic(channel).types
            meant = next((name for name in announced if name in names), names[0])
            self._classes[key] = message_class(meant, number)
        return self._classes[key]

    def _not_as_said(self, number: int) -> str:
        name = next(iter(candidates(number)), f"unknown, fingerprint {number:#018x}")
        return f"the type is not {type_name(self._said)} but {name}" if self._said else ""


def remedy_of_unknown() -> str:
    """What to do where no type has a fingerprint: mend .lcm files, or say where they are."""
    broken = next((str(problem.error()) for problem in problems()), "")
    return broken or f"{VARIABLE}=FOLDER says where your .lcm files are"


def raw_text(packet: Packet, reason: str) -> str:
    """A payload that cannot be decoded, as YAML all the same."""
    shown = packet.payload[:_SHOWN_BYTES].hex(" ")
    more = " ..." if len(packet.payload) > _SHOWN_BYTES else ""
    return f"# {reason}\nbytes: {len(packet.payload)}\ndata: '{shown}{more}'"


def raw_record(packet: Packet) -> dict[str, object]:
    """A payload as it is, for JSON."""
    return {"bytes": len(packet.payload), "data": packet.payload.hex()}
