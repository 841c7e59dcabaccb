"""Messages that have waited on their way."""

from hypothesis import given
from hypothesis import strategies as st

from lcmtools.wire.lateness import Lateness

SECOND = 1_000_000_000


@given(st.integers(-(2**62), 2**62))
def test_what_waited_for_a_second_is_late_whatever_the_clocks_are(offset):
    lateness = Lateness()
    ways = [0.05, 0.02, 0.9, 1.05, 2.5, 1.5, 0.8, 1.03]  # [s], one message each tenth of a second
    late = [
        lateness.is_late(number * SECOND // 10 + offset, number * SECOND // 10 + int(way * SECOND))
        for number, way in enumerate(ways)
    ]
    assert late == [False, False, False, True, True, True, False, True]


def test_clocks_that_drift_apart_make_nothing_late():
    lateness = Lateness()
    sent = [number * SECOND for number in range(10_000)]
    assert not any(lateness.is_late(time, time + time // 2000) for time in sent)
    assert lateness.is_late(sent[-1] + SECOND, sent[-1] + sent[-1] // 2000 + 3 * SECOND)


def test_messages_that_wait_are_late_for_as_long_as_they_do():
    lateness = Lateness()
    lateness.is_late(0, 0)
    assert not lateness.is_doubtful
    for time in range(1, 60):
        assert lateness.is_late(time * SECOND, (time + 6) * SECOND)
    assert lateness.is_doubtful
    lateness.compare(60 * SECOND, 60 * SECOND + SECOND // 10, SECOND // 5)  # an answer in time
    assert lateness.is_late(60 * SECOND, 66 * SECOND)
    assert not lateness.is_late(66 * SECOND, 66 * SECOND + SECOND // 2)


def test_an_answer_tells_that_a_clock_was_set():
    lateness = Lateness()
    lateness.is_late(0, 0)
    late = [lateness.is_late(time * SECOND, (time + 100) * SECOND) for time in range(1, 9)]
    assert all(late)
    lateness.compare(9 * SECOND, 112 * SECOND, 4 * SECOND)  # it had to wait: it tells nothing
    assert lateness.is_late(10 * SECOND, 110 * SECOND)
    lateness.compare(11 * SECOND, 111 * SECOND, SECOND // 100)
    assert not lateness.is_late(12 * SECOND, 112 * SECOND)
    assert lateness.is_late(13 * SECOND, 114 * SECOND + SECOND // 10)
