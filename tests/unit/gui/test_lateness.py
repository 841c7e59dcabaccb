"""The lateness of a page's requests, by two clocks that differ."""

import pytest

from lcmtools.gui.dead_man import LATEST_DRIVE, Lateness

_AHEAD = 1000.0  # [s] of the server's clock


def _latest(sent, came):
    """Return how late the last of some requests is."""
    lateness = Lateness()
    return [lateness.of(a, b + _AHEAD) for a, b in zip(sent, came, strict=True)][-1]


@pytest.mark.parametrize(
    ("sent", "came", "late"),
    [
        ([0.0], [0.0], 0.0),
        ([0.0, 0.1], [0.0, 0.1], 0.0),
        ([0.0, 0.1], [0.0, 2.1], 2.0),
        ([0.0, 0.1], [0.5, 0.1], 0.0),  # the first one was late
    ],
)
def test_the_least_delay_counts_as_none(sent, came, late):
    assert _latest(sent, came) == pytest.approx(late, abs=1e-3)


def test_all_that_waited_for_the_server_is_late_until_what_was_sent_just_now():
    lateness = Lateness()
    assert lateness.of(0.0, 0.0) == 0.0
    waited = [lateness.of(0.1 * n, 10.0 + 0.001 * n) for n in range(1, 100)]
    assert all(late > LATEST_DRIVE for late in waited[:95])
    assert lateness.of(10.2, 10.2) < LATEST_DRIVE


def test_clocks_that_drift_apart_do_not_make_requests_late():
    lateness = Lateness()
    assert max(lateness.of(0.1 * n, 0.1 * n * 1.00005) for n in range(36_000)) < 0.01


def test_a_clock_that_stood_still_is_believed_after_some_seconds():
    lateness = Lateness()
    lateness.of(0.0, 0.0)
    after = [lateness.of(0.1 * n, 60.0 + 0.1 * n) for n in range(1, 60)]
    assert after[0] > LATEST_DRIVE
    assert after[-1] < LATEST_DRIVE
