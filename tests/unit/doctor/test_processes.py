"""Processes of this computer as wtf sees them."""

import os
import threading
import time
from collections import defaultdict

import pytest

from lcmtools.bus.processes import Process
from lcmtools.doctor import lcm_processes
from lcmtools.doctor.evidence import LcmProcess
from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role


@pytest.mark.parametrize(("topic", "searches"), [("/rosout", 0), ("/scan", 1)])
def test_other_buses_are_searched_only_for_what_is_missing(topic, searches, monkeypatch):
    searched = []

    def topics(processes, _missed):
        searched.extend(process.bus for process in processes)
        return defaultdict(set), defaultdict(set, {9: {topic}})

    monkeypatch.setattr(lcm_processes, "_topics", topics)
    ends = tuple(Endpoint(name, Role.PUBLISHER) for name in (topic, "/_lcmtools/hidden"))
    graph = Graph((NodeInfo("/laser", "laser", "here", 1, endpoints=ends),))
    away = LcmProcess(9, "ear", "239.255.76.67:7670", "LCMTOOLS_DOMAIN=3")
    (found_away,) = lcm_processes.with_topics([away], graph)
    assert searched == [away.bus] * searches
    assert found_away.awaited == (topic,) * searches


def test_busy_time_is_that_of_all_threads():
    before, _ = Process(os.getpid()).processor_times
    begun, ends = threading.Event(), threading.Event()

    def compute():
        while time.thread_time_ns() < 50_000_000:
            pass
        begun.set()
        ends.wait()

    thread = threading.Thread(target=compute)
    thread.start()
    begun.wait()
    after, _ = Process(os.getpid()).processor_times
    ends.set()
    thread.join()
    assert after - before >= 50_000_000
