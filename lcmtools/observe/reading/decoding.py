"""Decoding: choosing the type of a channel's messages once, and reading the message in a packet."""

from collections.abc import Callable, Sequence

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
from lcmtools.packages.type_files import VARIABLE
from lcmtools.wire.packet import Packet


class UnknownFingerprint(DecodeError):  # noqa: N818 - named for what happened
    """No known type has the fingerprint of a payload."""


class Decoder:
    """Turns packets into messages.

    Two types with the same fields have the same fingerprint. The type that the user ``named`` takes
    precedence, then the one that nodes announce for the channel (``BusMonitor.types_of``), then the
    likeliest. ``keep_stray`` is passed to ``codec.decode``.
    """

    def __init__(
        self,
        announced: Callable[[str], Sequence[str]],
        named: type[Message] | None = None,
        *,
        keep_stray: bool = False,
    ) -> None:
        self._announced, self._named, self._keep_stray = announced, named, keep_stray
        self._classes: dict[tuple[str, bytes], type[Message]] = {}

    def message_class(self, packet: Packet) -> type[Message]:
        """Return the type of a packet's message.

        Raises:
            UnknownFingerprint: No known type has its fingerprint.
            DecodeError: It is too short for a message, or not of the type that the user named.
            LcmtoolsError: The type's .lcm file is wrong.
        """
        key = packet.channel, packet.payload[:8]
        known = self._classes.get(key)
        if known is None:
            number = packet.fingerprint
            if number is None:
                raise DecodeError("too short for an LCM message")
            known = self._classes[key] = self._settle(packet.channel, number)
        return known

    def decode(self, packet: Packet) -> Message:
        """Return the message in a packet; raises errors as ``message_class`` does."""
        return decode(self.message_class(packet), packet.payload, keep_stray=self._keep_stray)

    def _settle(self, channel: str, number: int) -> type[Message]:
        names = candidates(number)
        if self._named is not None:
            if fingerprint(self._named) == number:
                return self._named
            seen = names[0] if names else f"unknown, fingerprint {number:#018x}"
            raise DecodeError(f"the type is not {type_name(self._named)} but {seen}")
        if not names:
            raise UnknownFingerprint(f"unknown type, fingerprint {number:#018x}")
        meant = next((name for name in self._announced(channel) if name in names), names[0])
        return message_class(meant, number)


def remedy_of_unknown() -> str:
    """Return what to do about an unknown type: set the location of .lcm files, or correct them.

    Of a fingerprint nobody knows whether it belongs to a type in a broken file.
    """
    broken = len({problem.file for problem in problems()})
    files = f"{broken} broken type files" if broken > 1 else "a broken type file"
    more = f"; lcmtools msg build shows {files}" if broken else ""
    return f"{VARIABLE}=FOLDER adds the folder of your .lcm files{more}"
