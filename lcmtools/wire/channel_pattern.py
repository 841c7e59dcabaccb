r"""Regular expressions for channels, as in the subscriptions of tcpq, for a server.

Sans-I/O. They are Python's, and ``\Q...\E`` quotes; what java.util.regex and PCRE read otherwise is
refused. So is what may take long, so that no client can block a server with a pattern such as
"(a*)*b": more than six repetitions, or than three but "?", and repeated groups that contain
repetitions or alternatives.
"""

import re
import warnings

from lcmtools.errors import LcmtoolsError

_QUOTED = re.compile(r"\\Q(.*?)(?:\\E|\Z)", re.DOTALL)
_ONE = re.compile(r"\\.|\[\^?\]?(?:\\.|[^\]\\])*\]", re.DOTALL)  # an escape or a set of characters
_KIND = re.compile(r"\(\?(?:[:=!]|<[=!]|P<\w+>)")  # of a group
_GROUP = re.compile(r"\(([^()]*)\)([*+{]?)")
_REPETITION = re.compile(r"([*+]|\{\d*,?\d*\}|\?)[?+]?")
_MOST, _MOST_UNBOUNDED = 6, 3


class PatternError(LcmtoolsError):
    """A pattern that is not a regular expression, or uses unsupported syntax."""


class ChannelPattern:
    """A regular expression for whole channel names.

    Raises:
        PatternError: It cannot be parsed, or matching may take long.
    """

    def __init__(self, text: str) -> None:
        plain = _QUOTED.sub(lambda found: re.escape(found[1]), text)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")  # sets that other languages read as intersections
                self._pattern = re.compile(plain, re.ASCII)
        except (re.error, Warning, OverflowError, RecursionError) as error:
            raise PatternError(f"the pattern '{text}' is not supported: {error}") from None
        if _may_take_long(plain):
            raise PatternError(f"the pattern '{text}' is not supported: it repeats too much")

    def matches(self, name: str) -> bool:
        """Return whether the pattern matches the whole name."""
        return self._pattern.fullmatch(name) is not None


def _may_take_long(pattern: str) -> bool:
    rest = _KIND.sub("(", _ONE.sub("x", pattern))
    while group := _GROUP.search(rest):
        inner = group[1]
        if group[2] and ("|" in inner or _REPETITION.search(inner)):
            return True
        rest = f"{rest[: group.start()]}{inner}{rest[group.end(1) + 1 :]}"
    found = [one[1] for one in _REPETITION.finditer(rest)]
    return len(found) > _MOST or len(found) - found.count("?") > _MOST_UNBOUNDED
