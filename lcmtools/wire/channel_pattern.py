r"""Regular expressions for channels, as in the subscriptions of tcpq, for a server.

Sans-I/O. A pattern may use what java.util.regex and PCRE have in common: characters, classes,
groups, alternatives, repetitions, anchors and lookahead; it must match the whole name. Matching
takes polynomial time for every pattern, so that no client can block a server with one such as
"(a*)*b", for which a backtracking matcher takes exponential time: here the possible ends of each
part are computed once for each place where it can begin.
"""

import re
from collections.abc import Iterable
from typing import NamedTuple, TypeAlias

from lcmtools.errors import LcmtoolsError

_TOKEN = re.compile(
    r"""\\Q(?P<quoted>.*?)(?:\\E|\Z)
    | (?P<lookahead>\(\?[=!])
    | (?P<group>\((?:\?:|\?P?<\w+>)?(?!\?))
    | (?P<repeat>(?:[*+?]|\{\d+(?:,\d*)?\})\??(?![*+?{]))
    | (?P<set>\[\^?\]?(?:\\.|[^\]\\\[&])*\]|\\[dDwWsStnrf]|\\x[0-9a-fA-F]{2}|\\u[0-9a-fA-F]{4})
    | (?P<anchor>[\^$]|\\[AzZ])
    | (?P<syntax>[|)])
    | \\(?P<escaped>[^a-zA-Z0-9])
    | (?P<any>\.)
    | (?P<plain>[^\\\[(*+?{])""",
    re.VERBOSE | re.DOTALL,
)
_IGNORE_CASE = "(?i)"
_MOST_NESTED = 20
_START, _END = "^", "$"


class PatternError(LcmtoolsError):
    """A pattern that is not a regular expression, or uses unsupported syntax."""


class _One(NamedTuple):  # one character of a set
    characters: re.Pattern[str]


class _Row(NamedTuple):  # parts that follow each other
    parts: "tuple[_Part, ...]"


class _Choice(NamedTuple):  # alternatives, one of which must match
    parts: "tuple[_Part, ...]"


class _Repeat(NamedTuple):  # a repeated part
    part: "_Part"
    least: int
    most: int | None  # None for no limit


class _Ahead(NamedTuple):  # a part that must follow, or must not, and is not part of the match
    part: "_Part"
    wanted: bool


class _Anchor(NamedTuple):  # the beginning or the end of the name
    place: str


_Part: TypeAlias = "_One | _Row | _Choice | _Repeat | _Ahead | _Anchor"
_Places: TypeAlias = frozenset[int]


class ChannelPattern:
    """A regular expression for whole channel names.

    Raises:
        PatternError: It cannot be parsed.
    """

    def __init__(self, text: str) -> None:
        self._whole = _Reader(text).read()

    def matches(self, name: str) -> bool:
        """Return whether the pattern matches the whole name."""
        return len(name) in _Match(name).ends(self._whole, 0)


class _Reader:  # parses a pattern from its tokens
    def __init__(self, text: str) -> None:
        self._flags = re.ASCII
        self._text = text
        if text.startswith(_IGNORE_CASE):
            self._flags |= re.IGNORECASE
            self._text = text[len(_IGNORE_CASE) :]
        self._place = self._nested = 0

    def read(self) -> _Part:
        whole = self._choice()
        if self._place < len(self._text):
            raise self._malformed()
        return whole

    def _malformed(self) -> PatternError:
        place = f"from character {self._place + 1} on"
        return PatternError(f"the pattern '{self._text}' is not supported {place}")

    def _choice(self) -> _Part:
        self._nested += 1
        if self._nested > _MOST_NESTED:
            raise self._malformed()
        rows = [self._row()]
        while self._text[self._place : self._place + 1] == "|":
            self._place += 1
            rows.append(self._row())
        self._nested -= 1
        return _Choice(tuple(rows)) if len(rows) > 1 else rows[0]

    def _row(self) -> _Part:
        parts: list[_Part] = []
        while self._place < len(self._text):
            token = _TOKEN.match(self._text, self._place)
            if token is None or (token["repeat"] and not parts):
                raise self._malformed()
            if token["syntax"]:
                break
            self._place = token.end()
            if token["repeat"]:
                parts.append(_Repeat(parts.pop(), *_times(token["repeat"])))
            elif token["quoted"] is not None:
                parts += map(self._one, token["quoted"])
            else:
                parts.append(self._part(token))
        return _Row(tuple(parts))

    def _part(self, token: re.Match[str]) -> _Part:
        if token["lookahead"]:
            return _Ahead(self._closed(), token["lookahead"] == "(?=")
        if token["group"]:
            return self._closed()
        if token["anchor"]:
            return _Anchor(_START if token["anchor"] in ("^", r"\A") else _END)
        if token["set"] or token["any"]:
            try:
                return _One(re.compile(token[0], self._flags))
            except re.error:
                raise self._malformed() from None
        return self._one(token["escaped"] or token["plain"])

    def _closed(self) -> _Part:
        part = self._choice()
        if self._text[self._place : self._place + 1] != ")":
            raise self._malformed()
        self._place += 1
        return part

    def _one(self, character: str) -> _Part:
        return _One(re.compile(re.escape(character), self._flags))


def _times(text: str) -> tuple[int, int | None]:
    """The bounds of a repetition; a lazy one matches the same names."""
    if text[0] != "{":
        return {"*": (0, None), "+": (1, None), "?": (0, 1)}[text[0]]
    least, comma, most = text.rstrip("?")[1:-1].partition(",")
    return int(least[:9]), (int(most[:9]) if most else None if comma else int(least[:9]))


class _Match:
    """The places in a name where parts can end, found once for each place where they begin."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._known: dict[tuple[int, int], _Places] = {}

    def ends(self, part: _Part, start: int) -> _Places:
        key = id(part), start
        found = self._known.get(key)
        if found is None:
            found = self._known[key] = self._ends(part, start)
        return found

    def _ends(self, part: _Part, start: int) -> _Places:
        if isinstance(part, _One):
            one = part.characters.match(self._name, start, start + 1)
            return frozenset({start + 1}) if one else frozenset()
        if isinstance(part, _Row):
            places = frozenset({start})
            for inner in part.parts:
                places = self._all_ends(inner, places)
            return places
        if isinstance(part, _Choice):
            return frozenset().union(*(self.ends(one, start) for one in part.parts))
        if isinstance(part, _Repeat):
            return self._repeated(part, start)
        if isinstance(part, _Ahead):
            is_there = bool(self.ends(part.part, start)) is part.wanted
        else:
            is_there = start == (0 if part.place == _START else len(self._name))
        return frozenset({start}) if is_there else frozenset()

    def _all_ends(self, part: _Part, starts: Iterable[int]) -> _Places:
        return frozenset().union(*(self.ends(part, start) for start in starts))

    def _repeated(self, repeat: _Repeat, start: int) -> _Places:
        places = frozenset({start})
        for _ in range(repeat.least):
            before, places = places, self._all_ends(repeat.part, places)
            if places == before:
                break
        found, times = places, repeat.least
        while places and (repeat.most is None or times < repeat.most):
            places = self._all_ends(repeat.part, places) - found
            found, times = found | places, times + 1
        return found
