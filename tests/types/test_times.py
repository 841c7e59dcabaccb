"""Times of messages in fields of numbers: utime, timestamp and the like."""

import pytest

from lcmtools import message_class
from lcmtools.doctor.listening import Listening
from lcmtools.messages.codec import encode
from lcmtools.messages.message_template import draft_from_values
from lcmtools.messages.message_time import MessageTime, message_time
from lcmtools.wire.packet import Packet

NOW = 1_795_244_479_123_456_789
MICRO, MILLI = NOW // 10**3, NOW // 10**6


def drafted(name, text):
    return draft_from_values(message_class(f"times/{name}"), [text]).message


@pytest.mark.parametrize(
    ("name", "text", "field", "unit", "time"),
    [
        ("utime_t", f"utime: {MICRO}", "utime", "microseconds", MICRO * 10**3),
        ("utime_t", f"{{utime: 5, timestamp: {NOW}}}", "utime", "microseconds", 5000),
        ("timestamp_t", f"timestamp: {MICRO}", "timestamp", "microseconds", MICRO * 10**3),
        ("timestamp_t", f"timestamp: {MILLI}", "timestamp", "milliseconds", MILLI * 10**6),
        ("timestamp_t", f"timestamp: {NOW}", "timestamp", "nanoseconds", NOW),
        ("timestamp_t", f"timestamp: {NOW // 10**9}", "timestamp", "", 0),
        ("timestamp_t", "timestamp: 12", "timestamp", "", 0),
        ("timestamp_t", "timestamp: -5", "timestamp", "", 0),
        ("t_t", f"t: {MILLI}", "t", "milliseconds", MILLI * 10**6),
        ("time_us_t", f"time_us: {MICRO}", "time_us", "microseconds", MICRO * 10**3),
        ("camel_t", f"sensorTimeStamp: {NOW}", "sensorTimeStamp", "nanoseconds", NOW),
        ("seconds_t", "time: 1795244479.5", "time", "seconds", 1_795_244_479_500_000_000),
        ("seconds_t", "time: nan", "time", "", 0),
        ("seconds_t", "time: 3.5", "time", "", 0),
        ("two_t", f"sent_timestamp: {NOW}", "sent_timestamp", "nanoseconds", NOW),
        (
            "with_header_t",
            f"header: {{utime: {MICRO}}}",
            "header.utime",
            "microseconds",
            MICRO * 10**3,
        ),
    ],
)
def test_a_number_is_a_time_where_its_unit_makes_it_one(family, name, text, field, unit, time):
    family("times")
    found = message_time(drafted(name, text))
    assert found
    assert (found.field, found.unit, found.time) == (field, unit, time)


def test_other_numbers_are_no_times(family):
    family("times")
    assert message_time(drafted("no_time_t", f"count: {NOW}")) is None


def test_the_unit_is_told_except_the_usual_one():
    assert str(MessageTime("utime", 1, 1000, "microseconds")) == "utime"
    assert str(MessageTime("t", 1, 10**6, "milliseconds")) == "t (milliseconds)"
    assert str(MessageTime("header.stamp", 1, 1)) == "header.stamp"


def test_delay_says_by_which_field_it_is_measured(family, cli, log_of):
    family("times")
    times = [(10**18 + 10**8 * n) // 10**6 - 20 for n in range(3)]  # 20 ms before they arrive
    payloads = [encode(drafted("timestamp_t", f"timestamp: {time}")) for time in times]
    result = cli("delay", "-b", log_of("POSE", *payloads), "POSE")
    assert "the delay of POSE is measured by its timestamp (milliseconds)\n" in result.err
    assert "average delay: 0.020" in result.out


def test_delay_says_what_is_not_a_time(family, cli, log_of):
    family("times")
    log = log_of("POSE", *[encode(drafted("timestamp_t", "timestamp: 12"))] * 2)
    result = cli("delay", "-b", log, "POSE")
    assert "the timestamp of a message on POSE is 12, which is not a time" in result.err


@pytest.mark.parametrize(
    ("offset", "advances", "found"),
    [
        (0, True, []),
        (7200, True, [("future", "timestamp (milliseconds) is 7200.0 s in the future")]),
        (-7200, True, [("replayed", "timestamp (milliseconds) is 7200.0 s old")]),
        (-7200, False, []),  # of a message that is sent again and again
    ],
)
def test_wtf_checks_it(family, offset, found, *, advances):
    family("times")
    listening = Listening(lambda _: ("times/timestamp_t",))
    for second in range(3):
        moment = MILLI + 1 + (offset + advances * second) * 1000
        payload = encode(drafted("timestamp_t", f"timestamp: {moment}"))
        listening.add_packet(Packet("POSE", payload, NOW + second * 10**9))
    assert [(odd.kind, odd.text) for odd in listening.oddities(str)] == found
