"""A command answers a probe although its first announcement took long."""

import itertools
import time

from lcmtools.bus.records import this_process
from lcmtools.graph.protocol import PROBE_CHANNEL, Probe, encode_probe
from lcmtools.observe.reading.presence import Presence


def test_what_the_first_announcement_imports_delays_no_answer(monkeypatch):
    clock = itertools.chain([0.0, 0.5], itertools.count(0.5, 0.001))
    monkeypatch.setattr(time, "thread_time", lambda: next(clock))
    sent = []
    presence = Presence(
        this_process("/command", tool=True), lambda channel, _: sent.append(channel)
    )
    presence.announce()
    presence.answer(PROBE_CHANNEL, encode_probe(Probe()))
    assert len(sent) == 2
