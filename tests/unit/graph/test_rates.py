"""Rates over a window of arrivals."""

import math

import pytest

from lcmtools.graph.rates import RateWindow

_S = 1_000_000_000


def _window(*seconds: float, size: int = 100) -> RateWindow:
    window = RateWindow(size)
    window.extend(round(time * _S) for time in seconds)
    return window


def test_a_rate_is_one_over_the_mean_interval() -> None:
    rate = _window(0, 0.1, 0.3).take()
    assert rate is not None
    assert rate.mean == pytest.approx(2 / 0.3)
    assert (rate.shortest, rate.longest) == pytest.approx((0.1, 0.2))
    assert rate.deviation == pytest.approx(0.05)
    assert rate.window == 3


def test_only_the_latest_arrivals_count() -> None:
    window = _window(0, 100, 100.5, 101, size=3)
    rate = window.take()
    assert rate is not None
    assert rate.mean == pytest.approx(2.0)
    assert rate.window == 3
    assert window.total == 4


def test_nothing_new_is_no_rate() -> None:
    window = _window(0, 1)
    assert window.take() is not None
    assert window.take() is None
    window.extend([2 * _S])
    assert window.take() is not None


def test_one_arrival_is_no_rate() -> None:
    assert _window().take() is None
    assert _window(1).take() is None


def test_arrivals_at_one_instant_have_no_finite_rate() -> None:
    rate = _window(1, 1, 1).take()
    assert rate is not None
    assert rate.mean == 0.0
    assert math.isfinite(rate.deviation)
