"""Waking a thread that waits."""

import os
import threading
import time
from pathlib import Path

import pytest

from lcmtools.bus.wakeup import WakeupEvent


@pytest.fixture(autouse=True, params=["as it is", "without eventfd"])
def system(request, monkeypatch):
    """Other systems than Linux have no eventfd."""
    if request.param == "without eventfd":
        monkeypatch.delattr(os, "eventfd", raising=False)


def test_a_set_flag_makes_the_next_wait_return_at_once_and_only_that(stopwatch):
    wakeup = WakeupEvent()
    for _ in range(3):
        wakeup.set()
    watch = stopwatch()
    wakeup.wait(5.0)
    assert watch.seconds() < 1.0
    before = time.monotonic()
    wakeup.wait(0.02)
    assert time.monotonic() - before >= 0.015
    wakeup.close()


@pytest.mark.timing
def test_no_wake_up_is_lost_between_threads():
    """Work that is ready before the flag is set is always found without waiting long."""
    wakeup, work, done = WakeupEvent(), [], threading.Event()

    def produce():
        for number in range(5000):
            work.append(number)
            wakeup.set()
        done.set()

    producer = threading.Thread(target=produce)
    producer.start()
    seen, longest = 0, 0.0
    while seen < 5000:
        before = time.monotonic()
        wakeup.wait(60.0)
        longest = max(longest, time.monotonic() - before)
        seen = len(work)
    producer.join()
    assert longest < 30.0
    wakeup.close()


def test_a_closed_wakeup_may_be_set_and_frees_its_files():
    before = sorted(Path("/proc/self/fd").iterdir())
    wakeup = WakeupEvent()
    wakeup.close()
    wakeup.set()
    assert sorted(Path("/proc/self/fd").iterdir()) == before
