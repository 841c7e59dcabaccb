"""The comparison of what programs published with what was recorded. Pure: lists in, values out."""

import math
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import chain
from statistics import median
from typing import NamedTuple, cast

from lcmtools.clock import join_stamp
from lcmtools.errors import LcmtoolsError
from lcmtools.messages.fields import Field, is_time, visible_fields
from lcmtools.messages.message_time import UNITS, message_time, time_unit
from lcmtools.messages.registry import Message, type_name
from lcmtools.messages.shape import as_sequence

_ANGLE = re.compile(r"(?:.*_)?(?:roll|pitch|yaw|theta|heading|bearing|azimuth|angle)(_deg)?")
_COUNT = re.compile(r"(?:.*_)?(?:seq|seqno|sequence|sequence_number)")
_QUATERNION = ["x", "y", "z", "w"]


class Compared(NamedTuple):
    """A message: its time in the log, and its bytes."""

    time: int  # [ns since 1970]
    payload: bytes
    is_by_timer: bool = False
    cause: int = 0  # the time in the log of the input that it followed
    delay: int = 0  # from that input, by the computer's clock [ns]


@dataclass(frozen=True, slots=True)
class Tolerance:
    """The largest differences that count as none."""

    absolute: float = 1e-9
    relative: float = 1e-9
    delay: float = 0.1  # of stamps, and of messages against the others of their topic [s]
    is_by_order: bool = False  # True to match messages by their order alone, not by stamps
    fields: Mapping[str, str] = field(default_factory=dict)
    """Of fields and what is below them: "0.01", "5%", "angle", "ignore"."""

    def of(self, path: str) -> tuple[float, float, str]:
        """Return the absolute and relative tolerance of a field, and "angle", "ignore" or ""."""
        if self.fields:
            for place in _places(path):
                if (word := self.fields.get(place)) is not None:
                    return self._read(word)
        return self.absolute, self.relative, ""

    def _read(self, word: str) -> tuple[float, float, str]:
        if word in ("angle", "ignore"):
            return self.absolute, self.relative, word
        if word.endswith("%"):
            return 0.0, float(word[:-1]) / 100, ""
        return float(word), 0.0, ""


class Difference(NamedTuple):
    """A field whose value differs."""

    field: str
    recorded: object
    now: object
    size: float  # infinite if the values are no numbers
    excess: float  # the same, as a multiple of what is allowed
    time: int = 0  # of the recorded message [ns since 1970]

    @property
    def is_allowed(self) -> bool:
        """True if it is within the tolerance."""
        return self.excess <= 1

    @property
    def rank(self) -> tuple[bool, float]:
        """The order of differences: beyond the tolerance or not, then by size."""
        return not self.is_allowed, self.size

    def __str__(self) -> str:
        """Return the field with both values."""
        return f"{self.field} was {_text(self.recorded)}, now {_text(self.now)}"


@dataclass(slots=True)
class TopicComparison:
    """The messages of an output topic, as recorded and now."""

    topic: str
    recorded: int
    now: int
    matched: int = 0
    missing: list[int] = field(default_factory=list)  # times of recorded ones [ns since 1970]
    extra: list[int] = field(default_factory=list)  # times of new ones
    late: list[tuple[int, float]] = field(default_factory=list)  # times, and how much [s]
    differing: int = 0  # matched messages with a field beyond its tolerance
    largest: Difference | None = None
    first: Difference | None = None  # beyond its tolerance
    fields: Counter[str] = field(default_factory=Counter)  # that are, with their messages
    delay_recorded: float | None = None  # [s] after the input, the median
    delay_now: float | None = None  # by the computer's clock
    trouble: str = ""  # why its messages could not be compared
    pairs: list[tuple[int, int]] = field(default_factory=list)  # places of matched messages
    is_judged: bool = True  # False if the log does not have it

    @property
    def is_equal(self) -> bool:
        """True if nothing differs."""
        differs = self.missing or self.extra or self.late or self.differing or self.trouble
        return not (self.is_judged and differs)


class Clocks(NamedTuple):
    """The times and first messages that stamps and sequence numbers are relative to."""

    times: tuple[int, int]
    first: tuple[Message, Message] | None


Read = Callable[[str, bytes], Message]
"""Decodes a message of a topic; raises LcmtoolsError."""


def compare(
    topic: str,
    both: tuple[Sequence[Compared], Sequence[Compared]],
    read: Read,
    tolerance: Tolerance,
    *,
    judges_delay: bool = True,
) -> TopicComparison:
    """Compare the messages of a topic, recorded and now; without ``judges_delay`` none is late."""
    recorded, rerun = both
    found = TopicComparison(topic, len(recorded), len(rerun))
    stamps = None if tolerance.is_by_order else _stamps(topic, recorded, rerun, read)
    pairs = _by_stamp(*stamps) if stamps else _by_time(recorded, rerun)
    found.matched, found.pairs = len(pairs), pairs
    firsts, seconds = {one for one, _ in pairs}, {other for _, other in pairs}
    found.missing = [one.time for n, one in enumerate(recorded) if n not in firsts]
    found.extra = [one.time for n, one in enumerate(rerun) if n not in seconds]
    if rerun and all(one.is_by_timer for one in rerun):
        _forgive_ends(found, recorded, rerun)
    matched = [(recorded[one], rerun[other]) for one, other in pairs]
    if matched:
        shift = median(one.time - other.time for one, other in matched)
        found.delay_recorded = median(one.time - other.cause for one, other in matched) / 1e9
        found.delay_now = median(other.delay for _, other in matched) / 1e9
        late = [(one, (other.time - one.time + shift) / 1e9) for one, other in matched]
        if judges_delay:
            found.late = [(one.time, by) for one, by in late if abs(by) > tolerance.delay]
    try:
        _compare_fields(found, matched, read, tolerance)
    except LcmtoolsError as error:
        found.trouble = error.what
    return found


def _compare_fields(
    found: TopicComparison,
    matched: Sequence[tuple[Compared, Compared]],
    read: Read,
    tolerance: Tolerance,
) -> None:
    first = None
    for one, other in matched:
        if one.payload == other.payload:
            continue
        was, now = read(found.topic, one.payload), read(found.topic, other.payload)
        if type(was) is not type(now):
            kinds = f"{type_name(type(was))}, now {type_name(type(now))}"
            found.trouble = f"the type was {kinds}"
            return
        if first is None:
            start = matched[0]
            first = tuple(read(found.topic, each.payload) for each in start)
        clocks = Clocks((one.time, other.time), cast("tuple[Message, Message]", first))
        all_ = [each._replace(time=one.time) for each in differences(was, now, tolerance, clocks)]
        known = [found.largest] if found.largest else []
        found.largest = max((*known, *all_), key=lambda each: each.rank, default=None)
        beyond = [each for each in all_ if not each.is_allowed]
        found.fields.update(dict.fromkeys((each.field for each in beyond), 1))
        if beyond:
            found.differing += 1
            found.first = found.first or beyond[0]


def differences(
    was: Message, now: Message, tolerance: Tolerance, clocks: Clocks, path: str = ""
) -> Iterator[Difference]:
    """Yield the fields that differ at all, within their tolerance or not."""
    cls = type(was)
    if is_time(cls):
        first, second = (
            join_stamp(*(int(getattr(one, name)) for name in cls.__slots__)) for one in (was, now)
        )
        yield from _of_moments(path, (first, second), tolerance, clocks)
        return
    turned = _is_quaternion(cls) and _is_opposite(was, now)
    for part in visible_fields(cls):
        place = f"{path}.{part.name}" if path else part.name
        if tolerance.of(place)[2] == "ignore":
            continue
        first, second = getattr(was, part.attribute), getattr(now, part.attribute)
        inner = clocks
        if clocks.first and part.message_class and not part.depth:
            firsts = tuple(getattr(one, part.attribute) for one in clocks.first)
            inner = clocks._replace(first=cast("tuple[Message, Message]", firsts))
        elif part.depth:
            inner = clocks._replace(first=None)
        yield from _of_values(place, part, (first, -second if turned else second), tolerance, inner)


def _of_values(
    path: str, part: Field, values: tuple[object, object], tolerance: Tolerance, clocks: Clocks
) -> Iterator[Difference]:
    was, now = values
    if isinstance(was, (bool, str)) or (isinstance(was, bytes) and was != now):
        if was != now:
            yield Difference(path, was, now, math.inf, math.inf)
    elif isinstance(was, (int, float)) and isinstance(now, (int, float)):
        yield from _of_numbers(path, part, (was, now), tolerance, clocks)
    elif part.message_class and not isinstance(was, (list, tuple)):
        yield from differences(cast("Message", was), cast("Message", now), tolerance, clocks, path)
    elif was != now:
        first, second = as_sequence(was), as_sequence(now)
        if len(first) != len(second):
            size = abs(len(first) - len(second))
            yield Difference(f"{path} (length)", len(first), len(second), size, math.inf)
        for n, pair in enumerate(zip(first, second, strict=False)):
            yield from _of_values(f"{path}[{n}]", part, pair, tolerance, clocks)


def _of_numbers(
    path: str, part: Field, values: tuple[float, float], tolerance: Tolerance, clocks: Clocks
) -> Iterator[Difference]:
    was, now = values
    if was == now or (was != was and now != now):  # noqa: PLR0124 - NaN
        return
    name = part.name.lower()
    if (unit := time_unit(part)) and abs(was) > 1:
        ends = round(was * UNITS[unit]), round(now * UNITS[unit])
        yield from _of_moments(path, ends, tolerance, clocks, values)
        return
    if _COUNT.fullmatch(name) and clocks.first:
        before = [getattr(one, part.attribute) for one in clocks.first]
        if was - before[0] == now - before[1]:
            return
    absolute, relative, kind = tolerance.of(path)
    size = abs(now - was)
    if kind == "angle" or (known := _ANGLE.fullmatch(name)):
        turn = 360.0 if kind != "angle" and known and known[1] else math.tau
        size = abs(math.remainder(now - was, turn)) if math.isfinite(size) else size
    size = math.inf if math.isnan(size) else size
    allowed = max(absolute, relative * max(abs(was), abs(now)))
    excess = size / allowed if allowed else math.inf
    if size:
        yield Difference(path, was, now, size, excess)


def _of_moments(
    path: str,
    moments: tuple[int, int],
    tolerance: Tolerance,
    clocks: Clocks,
    shown: tuple[float, float] | None = None,
) -> Iterator[Difference]:
    """Compare times as such, or else against the times of their messages in the log."""
    was, now = moments
    ages = was - clocks.times[0], now - clocks.times[1]
    size = min(abs(was - now), abs(ages[0] - ages[1])) / 1e9
    if was != now:
        values = shown or (was / 1e9, now / 1e9)
        excess = size / tolerance.delay if tolerance.delay else math.inf
        yield Difference(path, *values, size, excess if size else 0.0)


@cache
def _places(path: str) -> tuple[str, ...]:
    """Return a path and those that it is below of, also without the places in arrays."""
    found = [path]
    while rest := max(found[-1].rfind("."), found[-1].rfind("["), 0):
        found.append(found[-1][:rest])
    plain = re.sub(r"\[\d+\]", "", path)
    return (*found, *(_places(plain) if plain != path else ()))


@cache
def _is_quaternion(cls: type[Message]) -> bool:
    return list(cls.__slots__) == _QUATERNION


def _is_opposite(was: Message, now: Message) -> bool:
    products = (float(getattr(was, name) * getattr(now, name)) for name in _QUATERNION)
    return sum(products) < 0


def _stamps(
    topic: str, recorded: Sequence[Compared], rerun: Sequence[Compared], read: Read
) -> tuple[list[object], list[object]] | None:
    """Return what identifies each message by its stamp; None if stamps do not identify them."""
    found = []
    try:
        for messages in (recorded, rerun):
            counts: Counter[float] = Counter()
            keys: list[object] = []
            for one in messages:
                moment = message_time(read(topic, one.payload))
                if moment is None:
                    return None
                keys.append((moment.value, counts[moment.value]))
                counts[moment.value] += 1
            found.append(keys)
    except LcmtoolsError:
        return None
    both = len(set(found[0]) & set(found[1]))
    is_known = both * 2 >= min(map(len, found)) and both > 0
    return (found[0], found[1]) if is_known else None


def _by_stamp(first: Sequence[object], second: Sequence[object]) -> list[tuple[int, int]]:
    places = {key: n for n, key in enumerate(second)}
    return [(n, places[key]) for n, key in enumerate(first) if key in places]


def _by_time(recorded: Sequence[Compared], rerun: Sequence[Compared]) -> list[tuple[int, int]]:
    """Match messages in their order; of the longer list, leave out those that fit worst by time."""
    short, long = sorted((recorded, rerun), key=len)
    pairs, place = list[tuple[int, int]](), 0

    def is_nearer(place: int, time: int) -> bool:
        """Return whether the next one is nearer to a time."""
        return abs(long[place + 1].time - time) < abs(long[place].time - time)

    for number, one in enumerate(short):
        last = len(long) - len(short) + number  # enough must be left for the others
        while place < last and is_nearer(place, one.time):
            place += 1
        pairs.append((number, place))
        place += 1
    return pairs if short is recorded else [(other, one) for one, other in pairs]


def _forgive_ends(
    found: TopicComparison, recorded: Sequence[Compared], rerun: Sequence[Compared]
) -> None:
    """Forget one unmatched message at each end: a timer's phase is not known from a log."""
    ends = {recorded[i].time for i in (0, -1) if recorded} | {rerun[i].time for i in (0, -1)}
    found.missing = [one for one in found.missing if one not in ends]
    found.extra = [one for one in found.extra if one not in ends]


def part_of(first: Sequence[Compared], second: Sequence[Compared]) -> int | None:
    """Return the place at which two lists of messages part, bytes and times; None if nowhere."""
    pairs = zip(chain(first, [None]), chain(second, [None]), strict=False)
    for n, (one, other) in enumerate(pairs):
        if (one and one[:2]) != (other and other[:2]):
            return n
    return None if len(first) == len(second) else min(len(first), len(second))


def _text(value: object) -> str:
    return f"{value:.9g}" if isinstance(value, float) else repr(value)
