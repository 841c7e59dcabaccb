"""Times within a log as a person writes them."""

import time

import pytest
from fixtures.says import raises_saying

from lcmtools.bag.times import parse_time, time_window
from lcmtools.errors import UsageError

_SECOND = 1_000_000_000
_START = 1_795_350_600 * _SECOND  # 2026-11-22 12:30:00 UTC
_END = _START + 90 * _SECOND


@pytest.fixture(autouse=True)
def berlin(monkeypatch):
    """The computer is where it is an hour later than UTC in winter."""
    monkeypatch.setenv("TZ", "CET-1")
    time.tzset()
    yield
    monkeypatch.undo()
    time.tzset()


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        ("10", 10),
        ("+10s", 10),
        ("start+1m", 60),
        ("start + 500ms", 0.5),
        ("0", 0),
        ("1h", 3600),
        ("start", 0),
        ("end", 90),
        ("end-1m", 30),
        ("-1m", 30),
        ("13:30:05", 5),
        ("13:30:05.5", 5.5),
        ("13:31", 60),
        ("2026-11-22 13:30:05", 5),
        ("2026-11-22T13:30:05.123456789", 5.123456789),
        ("2026-11-22 12:30:07Z", 7),
        ("2026-11-22 14:30:07 +0200", 7),
        ("2026-11-22 14:30:07+02:00", 7),
        ("1795350605", 5),
        ("1795350605.5", 5.5),
        ("9:30", -4 * 3600),
    ],
)
def test_a_time_is_found_in_a_log(text, seconds):
    assert parse_time(text).within(_START, _END) == _START + round(seconds * _SECOND)


def test_a_date_is_its_midnight():
    assert parse_time("2026-11-22").within(0, 1) == (_START // _SECOND - 13 * 3600 - 1800) * _SECOND


def test_a_time_of_the_day_may_be_after_midnight():
    start = _START + 10 * 3600 * _SECOND  # 23:30 there
    assert parse_time("00:10").within(start, start + 3600 * _SECOND) == start + 2400 * _SECOND
    assert parse_time("23:40").within(start, start + 3600 * _SECOND) == start + 600 * _SECOND


@pytest.mark.parametrize(
    "text",
    [
        *("", "soon", "10x", "1.2.3", "++1", "end+1m", "25:00", "12:61", "2026-13-01"),
        *("2026-11-22 12", "12:30Z", "end-", "-", "+", "1e3", "nan", "٣"),
    ],
)
def test_what_is_no_time_is_refused(text):
    with raises_saying(UsageError, "not a time", "10s", "end-1m"):
        parse_time(text)


def test_a_window_lies_within_the_log():
    span = _START, _END
    assert time_window(span) == span
    assert time_window(span, parse_time("9:30"), parse_time("2h")) == span
    assert time_window(span, parse_time("10"), parse_time("-10")) == (
        _START + 10 * _SECOND,
        _END - 10 * _SECOND,
    )
    assert time_window(span, parse_time("10"), duration=5) == (
        _START + 10 * _SECOND,
        _START + 15 * _SECOND,
    )


@pytest.mark.parametrize(
    ("start", "end", "what"),
    [
        ("91", None, "the start, 91, is after the end of the log; the log is 90.0 s long"),
        (None, "-91", "the end, -91, is before the start of the log; the log is 90.0 s long"),
        ("20", "10", "the start, 20, is after the end, 10; the log is 90.0 s long"),
    ],
)
def test_a_window_without_anything_of_the_log_is_refused(start, end, what):
    times = [parse_time(one) if one else None for one in (start, end)]
    with pytest.raises(UsageError) as caught:
        time_window((_START, _END), *times)
    assert str(caught.value) == what
