"""Names of topics, nodes and services: the ROS graph resource name rules, without ROS.

Belongs here: resolution, remapping, patterns and validation, as functions of text. Must not know
the command line, the environment or the bus.

The rules: https://wiki.ros.org/Names and https://wiki.ros.org/Remapping%20Arguments.
"""

import re
from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import NamedTuple

from lcmtools.errors import InvalidName

MAX_CHANNEL_BYTES = 63
"""LCM's limit for a channel name, in UTF-8 bytes (LCM_MAX_CHANNEL_NAME_LENGTH)."""

_LEGAL_NAME = re.compile(r"[~/A-Za-z][A-Za-z0-9_/]*", re.ASCII)
_TYPOGRAPHIC = re.compile("[\u2018-\u201f]")  # a shell does not take them for quotation marks
_LEGAL_BASE_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*", re.ASCII)

# as commands print control characters and bytes that are not UTF-8
_ESCAPE = re.compile(
    r"\\x([01][0-9a-f]|7f|[89a-f][0-9a-f])|\\u(20[0-9a-f]{2}|dc[89a-f][0-9a-f])", re.IGNORECASE
)

_NEAR = 0.65  # least similarity, 1 for equal names; "position" and "friction" have 0.625

_WILDCARD = re.compile(r"\*\*|[*?]")
_MEANINGS = {"**": ".*", "*": "[^/]*", "?": "[^/]"}

SELF_TEST_CHANNEL = "LCM_SELF_TEST"
"""The channel of liblcm's self-test, whose messages stay on the computer."""
# Channels that LCM itself uses, including the control channel of mpudpm.
_LCM_INTERNAL = (SELF_TEST_CHANNEL, "#!mpudpm")


class Resolver(NamedTuple):
    """Resolves the names in a node's code."""

    namespace: str = "/"  # the node's full namespace ("/husky0")
    node: str = ""  # its full name ("/husky0/simple_controller")
    remaps: tuple[tuple[str, str], ...] = ()  # (from, to) as given; resolved to be compared

    def resolve(self, name: str) -> str:
        """Return the full name of a topic or service, remapped.

        InvalidName is raised if it is illegal or too long for an LCM channel.
        """
        resolved = self.expand(name)
        for source, target in reversed(self.remaps):  # the last of several equal rules wins
            if self.expand(source) == resolved:
                return check_length(self.expand(target), name)
        return check_length(resolved, name)

    def spellings(self, name: str) -> Sequence[str]:
        """Return the channels that a name may mean when a topic is *read*, remapped."""
        if not name:
            raise InvalidName("the topic's name is empty", "lcmtools list shows the topics")
        found = spellings(name, self.namespace)
        for source, target in reversed(self.remaps):
            if not set(found).isdisjoint(spellings(source, self.namespace)):
                return spellings(target, self.namespace)
        return found

    def expand(self, name: str) -> str:
        """Return the full name before remapping."""
        return resolve(name, self.namespace, self.node)


def resolve(name: str, namespace: str = "/", node: str = "") -> str:
    """Return the full form of a name: "/a" unchanged, "a" in the namespace, "~a" below the node.

    InvalidName is raised for characters that ROS names do not have, and for "~a" without a node.
    """
    check_legal(name)
    if name.startswith("~"):
        if not node:
            what = f"'{name}' is private, and there is no node here"
            raise InvalidName(what, "write the name in full, for example /node/name")
        return _clean(f"{node}/{name[1:]}")
    return _clean(name if name.startswith("/") else f"{namespace}/{name}")


def resolve_namespace(namespace: str) -> str:
    """Return the full form of a namespace: "/husky0" for "husky0", "/" for ""."""
    return resolve(namespace, "/") if namespace else "/"


def check_legal(name: str) -> None:
    """Raise InvalidName unless it is a graph resource name, or empty for the namespace."""
    if name and _TYPOGRAPHIC.search(name):
        what = f"'{name}' has quotation marks as a printed text has them"
        raise InvalidName(what, """leave them out, or type " in their place""")
    if name and not _LEGAL_NAME.fullmatch(name):
        rule = "names are made of letters, digits, '_' and '/', and start with a letter, '/' or '~'"
        raise InvalidName(f"'{name}' is not a legal name", rule)


def check_node(name: str) -> None:
    """Raise InvalidName unless it is a node's full name."""
    check_legal(name)
    if resolve(name) != name or name == "/":
        raise InvalidName(f"'{name}' is not a node's full name", "for example /husky0/driver")


@lru_cache  # called for each message sent
def check_channel(channel: str) -> str:
    """Return a channel unchanged; raise InvalidName if it is empty, too long or not UTF-8."""
    if not is_utf_8(channel):
        raise InvalidName(f"the channel {channel!a} is not UTF-8", "use another name")
    return check_length(channel)


def check_base_name(name: str, namespace_by: str = "__ns:=") -> None:
    """Raise InvalidName unless it is a node's name without a namespace."""
    if not _LEGAL_BASE_NAME.fullmatch(name):
        rule = "a node's name is letters, digits and '_', and does not start with a digit"
        hint = f"{rule}; its namespace is given by {namespace_by}"
        raise InvalidName(f"'{name}' is not a legal node name", hint)


@lru_cache  # called for each message sent
def check_length(channel: str, name: str = "") -> str:
    """Return a channel unchanged; raise InvalidName if it is empty or longer than 63 bytes.

    The error also shows ``name``, from which the channel was resolved.
    """
    try:
        size = len(channel.encode("utf-8", "surrogateescape"))
    except UnicodeEncodeError as error:
        raise InvalidName(f"{channel!r} cannot be a channel's name") from error
    if size > MAX_CHANNEL_BYTES:
        source = f" (from '{name}')" if name and name != channel else ""
        limit = f"LCM channels have at most {MAX_CHANNEL_BYTES}"
        what = f"'{channel}'{source} has {size} bytes and {limit}"
        raise InvalidName(what, "use a shorter name or namespace")
    if not channel or "\0" in channel:
        raise InvalidName(f"{channel!r}: a channel name must not be empty or contain a zero byte")
    return channel


@lru_cache  # called for each message sent
def is_utf_8(channel: str) -> bool:
    """Return whether a channel's name is UTF-8; liblcm's Python sends on no other."""
    try:
        channel.encode()
    except UnicodeEncodeError:
        return False
    return True


def unescaped(name: str) -> str:
    r"""Return a name with ``\xff`` for a byte that is not UTF-8 as that byte, as it is shown.

    Also with control characters that are shown as ``\x1b`` or ``\u202e``.
    """

    def character(escape: "re.Match[str]") -> str:
        code = int(escape[1] or escape[2], 16)
        return chr(code + 0xDC00 if 0x80 <= code < 0x100 else code)  # noqa: PLR2004 - a byte

    found = _ESCAPE.sub(character, name)  # bytes that together are UTF-8 are a character
    return found.encode("utf-8", "surrogateescape").decode("utf-8", "surrogateescape")


def as_utf_8(name: str) -> str:
    r"""Return a channel's name as valid UTF-8, with other bytes escaped as ``\xff``."""
    return name.encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")


def is_hidden(name: str) -> bool:
    """Return True for a name that lists omit: a part starts with "_", or LCM itself uses it."""
    return name.startswith("_") or "/_" in name or is_of_lcm(name)


def is_of_lcm(channel: str) -> bool:
    """Return True for a channel that LCM itself uses, whose messages have no type."""
    return channel.startswith(_LCM_INTERNAL)


def namespace_of(name: str) -> str:
    """Return the namespace of a full name: "/husky0" for "/husky0/odometry"."""
    return name.rpartition("/")[0] or "/"


def base_name_of(name: str) -> str:
    """Return the last part of a full name."""
    return name.rpartition("/")[2]


def spellings(name: str, namespace: str = "/") -> Sequence[str]:
    """Return the channels that a name may mean when a topic is *read*: as written, and resolved.

    ``echo EXAMPLE`` may mean the plain LCM channel ``EXAMPLE`` or the topic ``/EXAMPLE``, whichever
    is on the bus. A name that is not a legal ROS name can only be a channel, also with escapes
    (``unescaped``).
    """
    if name.startswith("~") or not _LEGAL_NAME.fullmatch(name):
        return list(dict.fromkeys([name, unescaped(name)]))
    return list(dict.fromkeys([name, resolve(name, namespace)]))


class Pattern:
    """A name with wildcards, which mean the same in all commands.

    ``*`` matches any characters except "/", ``**`` any characters, and ``?`` one character except
    "/". Hidden names are only matched by a pattern with a hidden part. A relative pattern matches
    names as written and in the namespace.

    Args:
        text: The pattern; a name without wildcards matches itself.
        namespace: The namespace of a relative pattern.
        hidden: Match hidden names too.
    """

    def __init__(self, text: str, namespace: str = "/", *, hidden: bool = False) -> None:
        self._text = text
        self._hidden = hidden or is_hidden(text)
        bare = text.rstrip("/")
        root = "" if text.startswith("/") else f"(?:{re.escape(namespace.rstrip('/'))}/)?"
        said = "|".join(map(_expression, dict.fromkeys([bare, unescaped(bare)])))
        self._whole = re.compile(f"{root}(?:{said})", re.DOTALL)
        self._below = re.compile(f"{root}(?:{said})(/.*)?" if bare else ".*", re.DOTALL)

    def matches(self, name: str) -> bool:
        """Return True if the pattern matches the whole name."""
        return (self._hidden or not is_hidden(name)) and bool(self._whole.fullmatch(name))

    def covers(self, name: str) -> bool:
        """Return True if the pattern matches the name or a namespace around it.

        "" and "/" match all names.
        """
        return (self._hidden or not is_hidden(name)) and bool(self._below.fullmatch(name))

    def means_node(self, name: str) -> bool:
        """Return True if the pattern covers a node's name or matches its last part."""
        is_last = "/" not in self._text and self._whole.fullmatch(base_name_of(name))
        return self.covers(name) or (bool(is_last) and (self._hidden or not is_hidden(name)))


def has_wildcard(text: str) -> bool:
    """Return True for text that contains * or ?."""
    return _WILDCARD.search(text) is not None


def _expression(pattern: str) -> str:
    end, parts = 0, []
    for wildcard in _WILDCARD.finditer(pattern):
        parts += [re.escape(pattern[end : wildcard.start()]), _MEANINGS[wildcard[0]]]
        end = wildcard.end()
    return "".join(parts) + re.escape(pattern[end:])


def closest(name: str, known: Iterable[str], count: int = 1) -> list[str]:
    """Return the known names most similar to ``name``, best first, for "did you mean".

    A shared namespace does not make names more similar.
    """
    from difflib import SequenceMatcher, get_close_matches

    namespace, slash, last = name.lower().rpartition("/")
    by_last, by_all = SequenceMatcher(None, "", last), SequenceMatcher(None, "", name.lower())

    def is_near(candidate: str) -> bool:
        rest = candidate.removeprefix(namespace + slash)
        matcher = by_last if rest != candidate else by_all
        matcher.set_seq1(rest)
        ratios = matcher.real_quick_ratio, matcher.quick_ratio, matcher.ratio
        return all(ratio() >= _NEAR for ratio in ratios)  # the first two are quick upper bounds

    by_lower = {candidate.lower(): candidate for candidate in known}
    near = get_close_matches(name.lower(), filter(is_near, by_lower), count, _NEAR)
    return [by_lower[candidate] for candidate in near]


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return the hint "did you mean X?", or "" if no known name is similar."""
    near = closest(name, (other for other in known if other != name))
    return f"did you mean {near[0]}?" if near else ""


def _clean(name: str) -> str:
    """Collapse "//" and drop a trailing "/"."""
    return re.sub(r"/+", "/", name).rstrip("/") or "/"
