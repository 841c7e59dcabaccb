"""Zenoh keys for LCM channels, one for each. Only text.

A channel's key is its name below a prefix, percent-encoded where Zenoh has rules of its own: the
slash of "/odometry" would make an empty part; "#", "?", "$" and "*" have a meaning; and a part that
begins with "@" is hidden from patterns. Other slashes stay, so that "lcm/%2Fhusky0/**" is a
pattern.

Below the prefix "dimos", keys are those of dimos: "dimos/cmd_vel/geometry_msgs.Twist" is the topic
/cmd_vel with the type of its messages. There, a channel without a leading slash has the part "%".
"""

import re
from functools import lru_cache
from typing import NamedTuple
from urllib.parse import quote_from_bytes, unquote_to_bytes

DEFAULT_PREFIX = "lcm"
TYPED_PREFIX = "dimos"

_EDGE_SLASH = re.compile(r"^/|/$|(?<=/)/")
_TYPE = re.compile(r"[A-Za-z_]\w*\.[A-Za-z_]\w*", re.ASCII)
_RELATIVE = "%"  # a part that cannot be an encoded name
_LEGAL_PREFIX = re.compile(r"[A-Za-z0-9_.~-]+(/[A-Za-z0-9_.~-]+)*")


class Named(NamedTuple):
    """The channel that a key is for, and the type that the key names; "" for none."""

    channel: str
    type_name: str = ""


class Keys(NamedTuple):
    """The keys below a prefix."""

    prefix: str = DEFAULT_PREFIX

    @property
    def is_typed(self) -> bool:
        """True if the keys name the types of the messages, as in dimos."""
        return self.prefix.partition("/")[0] == TYPED_PREFIX

    def key(self, channel: str, type_name: str = "") -> str:
        """Return the key to publish a channel's messages on, of the type "package/Name"."""
        return _key(self, channel, type_name)

    def patterns(self, channel: str) -> tuple[str, ...]:
        """Return the patterns of the keys on which a channel's messages may arrive."""
        key = self.key(channel)
        return (key, f"{key}/*") if self.is_typed else (key,)

    @property
    def all(self) -> str:
        """The pattern of all keys."""
        return f"{self.prefix}/**"

    def named(self, key: str) -> Named | None:
        """Return the channel and type of a key; None if it is not below the prefix."""
        return _named(self, key)


def is_legal_prefix(prefix: str) -> bool:
    """Return whether a text can be a prefix: letters, digits and "_.~-", in parts."""
    return _LEGAL_PREFIX.fullmatch(prefix) is not None


@lru_cache(maxsize=4096)
def _key(keys: Keys, channel: str, type_name: str) -> str:
    if not keys.is_typed:
        return f"{keys.prefix}/{_EDGE_SLASH.sub('%2F', _quoted(channel))}"
    is_global = channel.startswith("/") and channel != "/"
    name, start = (channel[1:], "") if is_global else (channel, f"{_RELATIVE}/")
    *before, last = _EDGE_SLASH.sub("%2F", _quoted(name)).split("/")
    if _TYPE.fullmatch(last):  # the last part would be read as a type
        last = last.replace(".", "%2E")
    suffix = type_name.replace("/", ".")
    ending = (suffix,) if _TYPE.fullmatch(suffix) else ()
    return f"{keys.prefix}/{start}{'/'.join((*before, last, *ending))}"


@lru_cache(maxsize=4096)
def _named(keys: Keys, key: str) -> Named | None:
    if not key.startswith(f"{keys.prefix}/"):
        return None
    rest = key[len(keys.prefix) + 1 :]
    if not keys.is_typed:
        return Named(_unquoted(rest))
    type_name = ""
    before, slash, last = rest.rpartition("/")
    if slash and before != _RELATIVE and _TYPE.fullmatch(last):
        rest, type_name = before, last.replace(".", "/")
    is_relative = rest.startswith(f"{_RELATIVE}/")
    name = _unquoted(rest[2:] if is_relative else rest)
    return Named(name if is_relative else f"/{name}", type_name)


def _quoted(name: str) -> str:
    return quote_from_bytes(name.encode("utf-8", "surrogateescape"), safe="/")


def _unquoted(text: str) -> str:
    return unquote_to_bytes(text).decode("utf-8", "surrogateescape")
