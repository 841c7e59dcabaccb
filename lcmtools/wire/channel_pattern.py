r"""Regular expressions for channels, as in the subscriptions of tcpq, for a server.

Sans-I/O. A pattern is one of Python's ``re``, in which ``\Q...\E``, ``\z`` and ``(?<name>...)`` of
java.util.regex and PCRE may be used as well. ``re`` tries every way of matching, so a pattern with
more ways than _MOST_WAYS is refused: no client can block a server with one such as "(a*)*b".
"""

import importlib
import re
import sys
import warnings
from typing import Any

from lcmtools.errors import LcmtoolsError
from lcmtools.names import MAX_CHANNEL_BYTES

_parser: Any = importlib.import_module("re._parser" if sys.version_info >= (3, 11) else "sre_parse")
_MOST_WAYS = (MAX_CHANNEL_BYTES + 1) ** 3  # of three parts like ".*"
_FOREIGN = re.compile(
    r"\\Q(?P<quoted>.*?)(?:\\E|\Z) | (?P<group>\(\?<)(?=[A-Za-z]) | (?P<end>\\z) | \\.",
    re.VERBOSE | re.DOTALL,
)


class PatternError(LcmtoolsError):
    """A pattern that is not a regular expression, or could take too long to match."""


def compile_pattern(text: str) -> re.Pattern[str]:
    """Return a regular expression, whose ``fullmatch`` is for names of channels.

    Raises:
        PatternError: It cannot be parsed, or could take too long to match.
    """
    try:
        pattern = _FOREIGN.sub(_in_python, text)
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # sets that other languages read as intersections
            ways = _ways(_parser.parse(pattern, re.ASCII))
            compiled = re.compile(pattern, re.ASCII)
    except (re.error, ValueError, OverflowError, RecursionError, Warning) as error:
        position = getattr(error, "pos", None)
        place = "" if position is None else f" from character {position + 1} on"
        raise PatternError(f"the pattern '{text}' is not supported{place}") from None
    if ways > _MOST_WAYS:
        raise PatternError(f"the pattern '{text}' could take too long to match")
    return compiled


def _in_python(found: re.Match[str]) -> str:
    if found["quoted"] is not None:
        return re.escape(found["quoted"])
    return "(?P<" if found["group"] else r"\Z" if found["end"] else found[0]


def _ways(parts: Any) -> int:  # noqa: ANN401 - a parsed pattern of ``re``
    """Return a bound on the ways in which parts that follow each other can match a name."""
    ways = 1
    for operation, value in parts:
        ways = min(ways * _ways_of(str(operation), value), _MOST_WAYS + 1)
    return ways


def _ways_of(operation: str, value: Any) -> int:  # noqa: ANN401
    if operation.endswith("REPEAT"):
        least, most, inner = value
        ways, times = _ways(inner), min(int(most), MAX_CHANNEL_BYTES)
        return max(times - int(least), 0) + 1 if ways == 1 else (ways + 1) ** times
    if operation == "BRANCH":
        return sum(map(_ways, value[1]))
    if operation in ("SUBPATTERN", "ASSERT", "ASSERT_NOT"):
        return _ways(value[-1])
    if operation == "ATOMIC_GROUP":
        return _ways(value)
    return _MOST_WAYS + 1 if operation.startswith("GROUPREF") else 1
