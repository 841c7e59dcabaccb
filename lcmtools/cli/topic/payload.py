"""What a packet's payload says: decoded by the topic's type where that is known."""

from lcmtools.bus.watch import Watch
from lcmtools.errors import DecodeError
from lcmtools.messages.codec import decode
from lcmtools.messages.registry import Message, candidates, message_class
from lcmtools.wire.packet import Packet

_SHOWN_BYTES = 64


class Decoder:
    """Turns packets into messages.

    Two types with the same fields have the same fingerprint: a node's announcement settles which
    one is meant, else the likeliest is taken.
    """

    def __init__(self, watch: Watch) -> None:
        self._watch = watch
        self._classes: dict[tuple[str, int], type[Message] | None] = {}

    def decode(self, packet: Packet) -> Message | str:
        """The message, or why there is none."""
        fingerprint = packet.fingerprint
        if fingerprint is None:
            return "too short for an LCM message"
        key = (packet.channel, fingerprint)
        if key not in self._classes:
            self._classes[key] = self._find_class(*key)
        kind = self._classes[key]
        if kind is None:
            return f"unknown type, fingerprint {fingerprint:#018x}"
        try:
            return decode(kind, packet.payload)
        except DecodeError as error:
            return str(error)

    def _find_class(self, channel: str, fingerprint: int) -> type[Message] | None:
        names = candidates(fingerprint)
        announced = self._watch.graph().topic(channel).types
        name = next((name for name in announced if name in names), next(iter(names), None))
        return message_class(name) if name else None


def raw_text(packet: Packet, reason: str) -> str:
    """A payload that cannot be decoded, as YAML all the same."""
    shown = packet.payload[:_SHOWN_BYTES].hex(" ")
    more = " ..." if len(packet.payload) > _SHOWN_BYTES else ""
    return f"# {reason}\nbytes: {len(packet.payload)}\ndata: '{shown}{more}'"


def raw_record(packet: Packet) -> dict[str, object]:
    """A payload as it is, for JSON."""
    return {"bytes": len(packet.payload), "data": packet.payload.hex()}
