"""Times within a log as users write them.

    10, +10s, 1m, start+10s     this long after the start of the log
    -1m, end-1m, end            this long before its end
    12:30, 12:30:05.5           a time of the day in the computer's time zone
    2026-11-22 12:30:05         a date and time in the computer's time zone, or with Z or +01:00
    1795350605.5                seconds since 1970: any number from 100000000 on

Sans-I/O: the log's own start and end come in as arguments.
"""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timedelta
from decimal import Decimal
from numbers import Integral, Real

from lcmtools.clock import NANOSECONDS
from lcmtools.errors import UsageError
from lcmtools.settings import parse_duration

_EPOCH_FROM = 100_000_000  # [s] a smaller number is a time span
_EPOCH_TO = 10**12  # [s] a larger integer is one of nanoseconds
_AFTER = re.compile(r"(?:start)?\s*\+?\s*(?P<span>[\d.]+[a-z]*)", re.ASCII)
_BEFORE = re.compile(r"(?:end)?\s*-\s*(?P<span>[\d.]+[a-z]*)", re.ASCII)
_EPOCH = re.compile(r"\d{9,12}(?:\.\d*)?", re.ASCII)
_MOMENT = re.compile(
    r"(?:(?P<date>\d{4}-\d\d-\d\d)(?:[T ]|$))?"
    r"(?:(?P<time>\d?\d:\d\d(?::\d\d)?)(?:[.,](?P<part>\d{1,9}))?)?\s*(?P<zone>Z|[+-]\d\d:?\d\d)?",
    re.ASCII,
)
_HINT = "write 10s, end-1m, 12:30:05 or '2026-11-22 12:30:05'"


@dataclass(frozen=True, slots=True)
class LogTime:
    """A time within a log."""

    text: str  # as written
    _find: Callable[[int, int], int]

    def within(self, start: int, end: int) -> int:
        """Return the time [ns since 1970] in a log from ``start`` to ``end`` [ns since 1970].

        It may lie outside of the log.
        """
        return self._find(start, end)


def parse_time(text: str) -> LogTime:
    """Return the time for a text; UsageError if it is not a time."""
    said = text.strip()
    if said in ("start", "end"):
        return LogTime(text, lambda start, end: start if said == "start" else end)
    if _EPOCH.fullmatch(said) and Decimal(said) >= _EPOCH_FROM:
        moment = int(Decimal(said) * NANOSECONDS)
        return LogTime(text, lambda _start, _end: moment)
    if form := _AFTER.fullmatch(said):
        after = _nanoseconds(text, form["span"])
        return LogTime(text, lambda start, _end: start + after)
    if form := _BEFORE.fullmatch(said):
        before = _nanoseconds(text, form["span"])
        return LogTime(text, lambda _start, end: end - before)
    form = _MOMENT.fullmatch(said)
    if not (form and (form["date"] or form["time"])) or (form["zone"] and not form["date"]):
        raise UsageError(f"'{text}' is not a time", _HINT)
    return _moment(text, form)


def time_of(value: str | float) -> LogTime:
    """Return the time for a text, or for a number: one of seconds, as in a text, or an int in ns.

    An int is in nanoseconds since 1970 if it lies within the log, as ``Log.start`` does, or if in
    seconds it would be beyond the year 30000.

    Raises:
        UsageError: It is not a time.
    """
    if isinstance(value, str):
        return parse_time(value)
    if isinstance(value, bool) or not isinstance(value, Real) or not math.isfinite(value):
        raise UsageError(f"{value!r} is not a time", _HINT)
    is_integer = isinstance(value, Integral)
    seconds = round(float(value) * NANOSECONDS)

    def find(start: int, end: int) -> int:
        if is_integer and (start <= value <= end or abs(value) > _EPOCH_TO):
            return int(value)
        if value >= _EPOCH_FROM:
            return seconds
        return (end if value < 0 else start) + seconds

    return LogTime(str(value), find)


def time_window(
    span: tuple[int, int],
    start: LogTime | None = None,
    end: LogTime | None = None,
    *,
    duration: float | None = None,
) -> tuple[int, int]:
    """Return the first and the last time [ns since 1970] of a part of a log of this ``span``.

    Without ``start`` or ``end`` it begins or ends with the log; ``duration`` [s] is its limit.

    Raises:
        UsageError: Nothing of the log lies between them.
    """
    first = max(start.within(*span), span[0]) if start else span[0]
    last = min(end.within(*span), span[1]) if end else span[1]
    length = f"the log is {(span[1] - span[0]) / NANOSECONDS:.1f} s long"
    if start and first > span[1]:
        raise UsageError(f"the start, {start.text}, is after the end of the log", length)
    if end and last < span[0]:
        raise UsageError(f"the end, {end.text}, is before the start of the log", length)
    if first > last:
        said = f"the start, {start.text}," if start else "the start"
        raise UsageError(f"{said} is after the end, {end.text if end else 'end'}", length)
    if duration is not None:
        last = min(last, first + round(duration * NANOSECONDS))
    return first, last


def _nanoseconds(text: str, span: str) -> int:
    try:
        return round(parse_duration(span) * NANOSECONDS)
    except UsageError:
        raise UsageError(f"'{text}' is not a time", _HINT) from None


def _moment(text: str, form: "re.Match[str]") -> LogTime:
    """Return the time for a date, a time of the day, or both."""
    hour, *rest = (form["time"] or "00:00").split(":")
    clock = ":".join([hour.zfill(2), *rest])
    part = int((form["part"] or "0").ljust(9, "0"))
    zone = (form["zone"] or "").replace("Z", "+00:00")
    zone = zone if ":" in zone or not zone else f"{zone[:3]}:{zone[3:]}"

    def moment(date: str) -> int:
        return int(datetime.fromisoformat(f"{date}T{clock}{zone}").timestamp()) * NANOSECONDS + part

    date = form["date"]
    try:
        fixed = moment(date or "2000-01-01")
    except (ValueError, OverflowError) as error:
        raise UsageError(f"'{text}' is not a time: {error}", _HINT) from None
    if date:
        return LogTime(text, lambda _start, _end: fixed)

    def of_the_day(start: int, end: int) -> int:
        """Return the time on the day of the log's start, or the next day if the log reaches it."""
        day = datetime.fromtimestamp(start / NANOSECONDS).date()  # noqa: DTZ006 - local
        found, later = moment(day.isoformat()), moment((day + timedelta(days=1)).isoformat())
        return later if found < start and later <= end else found

    return LogTime(text, of_the_day)
