"""Measurements of a live bus by the computer's clock."""

import time
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor
from threading import Event

import pytest

from lcmtools.bus.url import parse_url
from lcmtools.observe.measuring import measure
from lcmtools.observe.measuring.measure import ListenOptions, Measurement
from lcmtools.observe.measuring.rates import RateWindow
from lcmtools.observe.reading.monitor import BusMonitor


@pytest.mark.parametrize("seconds", [-3600.0, 3600.0])
def test_a_clock_that_is_set_begins_the_window_again(bus_url, bus, monkeypatch, seconds):
    """One wrong interval would count for as long as it is in the window."""
    windows = defaultdict(lambda: RateWindow(50_000))
    real, ended = time.time, Event()

    def send():
        while not ended.wait(0.01):
            bus.publish("A", b"x")

    with BusMonitor(parse_url(bus_url), "hz", {}) as monitor, ThreadPoolExecutor(1) as threads:
        threads.submit(send)
        try:
            options = ListenOptions(timeout=40.0)
            made = Measurement(monitor, ["A"], windows, lambda one: one.time, options, print)
            reports = made.reports()
            next(report for report in reports if report.found.get("A"))
            before = windows["A"].total
            monkeypatch.setattr(measure.time, "time", lambda: real() + seconds)
            assert any(report.is_reset for report in reports)
            report = next(report for report in reports if report.found.get("A"))
            assert report.found["A"] is not None
            assert report.found["A"].window <= windows["A"].total - before
            assert not report.is_reset
        finally:
            ended.set()
