"""Decoding: choosing the type of a channel's messages once, and reading the message in a packet."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import lru_cache

from lcmtools.bounded import MOST_ENTRIES, BoundedDict
from lcmtools.errors import DecodeError, UnknownType
from lcmtools.messages.codec import decode
from lcmtools.messages.registry import (
    Message,
    candidates,
    fingerprint,
    message_class,
    problems,
    type_name,
    versioned,
)
from lcmtools.messages.type_names import full_name
from lcmtools.names import is_of_lcm
from lcmtools.packages.type_files import VARIABLE
from lcmtools.wire.packet import Packet

_SAME_FILES = "generate the code of both sides from the same .lcm files: lcm-gen"


class UnknownFingerprint(DecodeError):  # noqa: N818 - named for what happened
    """No known type has the fingerprint of a payload."""


def possible_types(number: int, channel: str = "", announced: Sequence[str] = ()) -> list[str]:
    """Return the types that messages with a fingerprint may have, the likeliest first.

    Types with the same fields have the same fingerprint. There is only one if nodes have
    ``announced`` it, or if a channel's name ends in it ("/odom#nav_msgs.Odometry").
    """
    names = candidates(number, channel)
    said = (*announced, full_name(channel.rpartition("#")[2]))
    found = next(([name] for name in said if name in names), names)
    return [versioned(name, number) for name in found]


class Decoder:
    """Turns packets into messages.

    The type that the user ``named`` takes precedence, with all of its versions unless ``exact``;
    then the one that nodes announce for the channel (``BusMonitor.types_of``), then the likeliest.
    ``keep_stray`` is passed to ``codec.decode``.
    """

    def __init__(
        self,
        announced: Callable[[str], Sequence[str]],
        named: type[Message] | None = None,
        *,
        exact: bool = False,
        keep_stray: bool = False,
    ) -> None:
        self._announced, self._named, self._keep_stray = announced, named, keep_stray
        self._exact = exact
        self._settled = BoundedDict[tuple[str, bytes], tuple[type[Message], Sequence[str]]]()

    def message_class(self, packet: Packet) -> type[Message]:
        """Return the type of a packet's message.

        Raises:
            UnknownFingerprint: No known type has its fingerprint.
            DecodeError: It is too short for a message, or not of the type that the user named.
            LcmtoolsError: The type's .lcm file is wrong.
        """
        return self._known(packet)[0]

    def types(self, packet: Packet) -> Sequence[str]:
        """Return the types that its message may have, likeliest first; see ``message_class``."""
        return self._known(packet)[1]

    def decode(self, packet: Packet) -> Message:
        """Return the message in a packet; raises errors as ``message_class`` does."""
        return decode(self.message_class(packet), packet.payload, keep_stray=self._keep_stray)

    def _known(self, packet: Packet) -> tuple[type[Message], Sequence[str]]:
        key = packet.channel, packet.payload[:8]
        known = self._settled.use(key)
        if known is None:
            number = packet.fingerprint
            if number is None:
                raise DecodeError("too short for an LCM message")
            known = self._settled[key] = self._settle(packet.channel, number)
        return known

    def _settle(self, channel: str, number: int) -> tuple[type[Message], Sequence[str]]:
        if is_of_lcm(channel):
            raise DecodeError("LCM's own message, which has no type")
        if self._named is not None:
            return self._settle_named(channel, number, self._named)
        names = possible_types(number, channel, self._announced(channel))
        for place, name in enumerate(names):
            with suppress(UnknownType):  # an index may name one that it does not define
                return message_class(name, number), names[place:]
        raise unknown_fingerprint(number, channel, self._announced(channel))

    def _settle_named(
        self, channel: str, number: int, named: type[Message]
    ) -> tuple[type[Message], Sequence[str]]:
        name = type_name(named)
        if fingerprint(named) == number:
            return named, [versioned(name, number)]
        if name in candidates(number) and not self._exact:
            return message_class(name, number), [versioned(name, number)]
        names = possible_types(number, channel, self._announced(channel))
        like = like_text(number, channel, (type_name(named),))
        seen = names[0] if names else f"unknown, fingerprint {number:#018x}{like}"
        meant = versioned(name, fingerprint(named))
        raise DecodeError(f"the type is not {meant} but {seen}")


def unknown_fingerprint(
    number: int, channel: str, announced: Sequence[str] = ()
) -> UnknownFingerprint:
    """Return the error for a fingerprint of no known type, with the type that is most like it."""
    like = like_text(number, channel, tuple(announced))
    hint = _SAME_FILES if like else ""
    return UnknownFingerprint(f"unknown type, fingerprint {number:#018x}{like}", hint)


@lru_cache(maxsize=MOST_ENTRIES)
def like_text(number: int, channel: str, announced: tuple[str, ...] = ()) -> str:
    """Return ": like nav_msgs/Odometry, but without the field twist", as wtf does; "" for none."""
    from lcmtools.messages.type_versions import may_be_fingerprint, other_version, own_types_like

    if not may_be_fingerprint(number):
        return ""
    near = other_version(number, (*announced, *own_types_like(channel)))
    return f": like {near.name}, but {near.difference}" if near else ""


def remedy_of_unknown() -> str:
    """Return what to do about an unknown type: set the location of .lcm files, or correct them.

    Of a fingerprint nobody knows whether it belongs to a type in a broken file.
    """
    if folder := next((str(one.error()) for one in problems() if one.is_of_folder), ""):
        return folder
    broken = len({problem.file for problem in problems()})
    files = f"{broken} broken type files" if broken > 1 else "a broken type file"
    more = f"; lcmtools msg build shows {files}" if broken else ""
    return f"{VARIABLE}=FOLDER adds the folder of your .lcm files{more}"
