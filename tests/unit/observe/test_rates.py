"""Rates over a window of arrivals."""

from itertools import pairwise
from statistics import pstdev

import pytest
from fixtures.says import assert_says

from lcmtools.errors import DecodeError
from lcmtools.messages.layout import stamp_reader
from lcmtools.messages.message_time import MessageTime
from lcmtools.observe.measuring.measure import Delays
from lcmtools.observe.measuring.rate_report import DELAY
from lcmtools.observe.measuring.rates import BandwidthWindow, DelayWindow, RateWindow, Statistics
from lcmtools.observe.reading.arrivals import SelectedPacket
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.types.geometry_msgs import PoseStamped, Twist
from lcmtools.wire.packet import Packet

_S = 1_000_000_000


def _window(*seconds, size=100):
    window = RateWindow(size)
    for time in seconds:
        window.add(round(time * _S))
    return window


def test_a_rate_is_one_over_the_mean_interval():
    rate = _window(0, 0.1, 0.3).next_result()
    assert rate.mean == pytest.approx(2 / 0.3)
    assert (rate.shortest, rate.longest) == pytest.approx((0.1, 0.2))
    assert rate.deviation == pytest.approx(0.05)
    assert rate.window == 3


def test_only_the_latest_arrivals_count():
    window = _window(0, 100, 100.5, 101, size=3)
    rate = window.next_result()
    assert rate.mean == pytest.approx(2.0)
    assert rate.window == 3
    assert window.total == 4


def test_nothing_new_is_no_rate_nor_is_one_arrival():
    window = _window(0)
    assert window.next_result() is None
    window.add(_S)
    assert window.next_result() is not None
    assert window.next_result() is None


def test_a_small_deviation_is_exact_in_a_large_window():
    window = DelayWindow(50_000)
    for number in range(50_000):
        window.add(-100 * 86_400 * _S + number % 2)  # a clock that is days ahead
    delay = window.next_result()
    assert delay.deviation == 0.5e-9


@pytest.mark.parametrize("size", [2, 1000, 1001, 2500])
def test_a_long_window_has_the_figures_of_its_latest_arrivals(size):
    times = [number * number for number in range(6000)]
    window = RateWindow(size)
    for start in range(0, 6000, 700):
        window.add(*times[start : start + 700])
        assert window.next_result() is not None
    window.add(6000 * 6000)
    rate, latest = window.next_result(), [*times[-size + 1 :], 6000 * 6000]
    intervals = [later - one for one, later in pairwise(latest)]
    assert rate.mean == (size - 1) * 1e9 / (latest[-1] - latest[0])
    assert (rate.shortest, rate.longest) == (min(intervals) / 1e9, max(intervals) / 1e9)
    assert rate.deviation == pytest.approx(pstdev(intervals) / 1e9)
    assert rate.window == size


def test_arrivals_at_one_instant_have_no_rate():
    window = _window(1, 1, 1)
    assert window.next_result() is None
    assert window.is_timeless
    window.add(2)
    assert window.next_result() is not None
    assert not window.is_timeless


@pytest.mark.parametrize(
    ("size", "items", "now", "average", "rest"),
    [
        (10, [(0, 100), (_S, 101), (2 * _S, 102)], 3 * _S, 303 / 3, (101, 100, 102, 3)),
        (10, [(0, 100), (_S, 100)], 20 * _S, 10, (100, 100, 100, 2)),  # it falls
        (2, [(0, 1), (_S, 10), (2 * _S, 20)], 3 * _S, 15, (15, 10, 20, 2)),  # the latest
        (10, [(_S, 100), (3 * _S, 100)], 0, 100, (100, 100, 100, 2)),  # at the last arrival
        (2, [(_S, 1), (_S, 1)], _S, 0.0, (1, 1, 1, 2)),  # of an instant
    ],
)
def test_bandwidth_is_the_windows_bytes_over_the_time_since_its_first_arrival(
    size, items, now, average, rest
):
    window = BandwidthWindow(size)
    for item in items[:-1]:
        window.add(item)
    assert len(items) > 2 or window.next_result(now) is None  # it needs two
    window.add(items[-1])
    found = window.next_result(now)
    assert (found.average, found[1:]) == (pytest.approx(average), rest)


def test_delays_are_summed_up_and_reported_once():
    window = DelayWindow(10)
    assert window.next_result() is None
    window.add(_S)
    window.add(3 * _S)
    delay = window.next_result()
    assert (delay.mean, delay.shortest, delay.longest) == pytest.approx((2, 1, 3))
    assert (delay.deviation, delay.window) == (pytest.approx(1.0), 2)
    assert window.next_result() is None


def test_a_delay_is_arrival_less_stamp_and_exact_for_times_since_1970():
    message = PoseStamped()
    message.header.stamp.sec, message.header.stamp.nsec = 1_795_244_479, 0
    packet = Packet("/a", message.encode(), 0)
    delay = Delays(Decoder(lambda _: ()), print)
    assert delay(SelectedPacket("/a", packet, 1_795_244_479_000_000_123)) == 123


@pytest.mark.parametrize(
    ("stamped", "arrival", "said"),
    [
        (12, 1_795_244_479, "is 12.000 s: since a start"),
        (1_795_244_479, 12, "is real time, while /clock is at 12.000 s"),
    ],
)
def test_a_stamp_of_another_time_base_is_told_once_and_has_no_delay(stamped, arrival, said):
    message, told = PoseStamped(), []
    message.header.stamp.sec = stamped
    delay = Delays(Decoder(lambda _: ()), told.append)
    for _ in range(2):
        packet = Packet("/a", message.encode(), 0)
        assert delay(SelectedPacket("/a", packet, arrival * 10**9)) is None
    (line,) = told
    assert_says(line, "/a", said)


def test_without_a_header_the_delay_is_that_of_utime(monkeypatch):
    delay, packet = Delays(Decoder(lambda _: ()), print), Packet("/a", Twist().encode(), 0)
    found = MessageTime("utime", 7, 7000, "microseconds")
    monkeypatch.setattr("lcmtools.observe.measuring.measure.message_time", lambda _: found)
    assert delay(SelectedPacket("/a", packet, 9000)) == 2000


def test_a_message_that_is_cut_off_has_no_delay():
    message = PoseStamped()
    message.header.stamp.sec = 1
    delay, payload = Delays(Decoder(lambda _: ()), print), message.encode()
    for number in range(2):
        assert delay(SelectedPacket("/a", Packet("/a", payload, 0), 10**9 + number)) == number
    with pytest.raises(DecodeError):
        delay(SelectedPacket("/a", Packet("/a", payload[:-1], 0), 10**9))


def test_a_stamp_has_a_place_where_only_numbers_come_before_it():
    message = PoseStamped()
    message.header.stamp.sec, message.header.stamp.nsec = 12, 345
    read = stamp_reader(PoseStamped)
    assert read is not None
    assert tuple(read(message.encode())) == (12, 345)
    assert stamp_reader(Twist) is None


def test_a_window_that_is_cleared_begins_again():
    rates = _window(0, 1)
    rates.clear()
    rates.add(100 * _S)
    assert rates.next_result() is None
    rates.add(100 * _S + _S // 2)
    rate = rates.next_result()
    assert rate.mean == pytest.approx(2)
    sizes, delays = BandwidthWindow(5), DelayWindow(5)
    sizes.add((0, 1))
    sizes.add((_S, 1))
    delays.add(_S)
    sizes.clear()
    delays.clear()
    assert (sizes.next_result(2 * _S), delays.next_result()) == (None, None)


def test_small_delays_are_in_microseconds():
    small, large = Statistics(1.2e-4, -3e-5, 3e-4, 5e-5, 9), Statistics(0.02, 1e-4, 0.03, 1e-3, 9)
    assert DELAY.to_lines({"/a": small}) == [
        "average delay: 120 us",
        "\tmin: -30us max: 300us std dev: 50us window: 9",
    ]
    assert DELAY.to_lines({"/a": large}) == [
        "average delay: 0.020",
        "\tmin: 0.000s max: 0.030s std dev: 0.00100s window: 9",
    ]
