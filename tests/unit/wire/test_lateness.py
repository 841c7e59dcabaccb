"""Messages that have waited on their way."""

from hypothesis import given
from hypothesis import strategies as st

from lcmtools.wire.lateness import Lateness

SECOND = 1_000_000_000


@given(st.integers(-(2**62), 2**62))
def test_what_waited_for_a_second_is_late_whatever_the_clocks_are(offset: int) -> None:
    lateness = Lateness()
    ways = [0.05, 0.02, 0.9, 1.05, 2.5, 1.5, 0.8, 1.03]  # [s], one message each tenth of a second
    late = [
        lateness.is_late(number * SECOND // 10 + offset, number * SECOND // 10 + int(way * SECOND))
        for number, way in enumerate(ways)
    ]
    assert late == [False, False, False, True, True, True, False, True]


def test_clocks_that_drift_apart_make_nothing_late() -> None:
    lateness = Lateness()
    sent = [number * SECOND for number in range(10_000)]
    assert not any(lateness.is_late(time, time + time // 2000) for time in sent)
    assert lateness.is_late(sent[-1] + SECOND, sent[-1] + sent[-1] // 2000 + 3 * SECOND)


def test_a_clock_that_was_set_makes_messages_late_for_ten_seconds() -> None:
    lateness = Lateness()
    lateness.is_late(0, 0)
    late = [lateness.is_late(time * SECOND, (time + 100) * SECOND) for time in range(1, 30)]
    assert late == [True] * 11 + [False] * 18
    assert lateness.is_late(30 * SECOND, 132 * SECOND)
