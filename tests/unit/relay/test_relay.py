"""A relay, without buses and threads."""

from types import SimpleNamespace

from lcmtools.bus.url import parse_url
from lcmtools.graph.model import NodeInfo
from lcmtools.graph.protocol import (
    NODE_CHANNEL,
    PROBE_CHANNEL,
    Announcement,
    Probe,
    encode_announcement,
    encode_probe,
)
from lcmtools.relay import relay
from lcmtools.relay.rules import Rules
from lcmtools.wire.packet import Packet


def test_a_flood_of_probes_gets_few_answers_and_the_last_one_is_answered(monkeypatch):
    end = SimpleNamespace(ports=(), takes_origin=False, is_quick=True, trouble="", dropped=0)
    end.losses = end.close = dict
    monkeypatch.setattr(relay, "open_end", lambda _: end)
    urls = parse_url("udpm://239.255.76.67:1"), parse_url("udpm://239.255.76.67:2")
    tested = relay.Relay(urls, Rules(), lambda _: None, name="/relay")
    tested._carries = True
    for number in range(100):
        payload = encode_announcement(Announcement(NodeInfo(f"/n{number}", str(number), "ada", 7)))
        tested._hear(0, Packet(NODE_CHANNEL, payload, 0))
    told, clock = [], SimpleNamespace(now=100.0, worked=0.0)

    def thread_time():
        clock.worked += 0.5
        return clock.worked

    for name, tell in (("monotonic", lambda: clock.now), ("thread_time", thread_time)):
        monkeypatch.setattr(relay.time, name, tell)
    monkeypatch.setattr(tested._sides[1], "send_first", lambda channel, _: told.append(channel))
    for _ in range(200):
        tested._hear(1, Packet(PROBE_CHANNEL, encode_probe(Probe()), 0))
    assert told.count(NODE_CHANNEL) == 100
    clock.now += 0.5
    tested._answer_owed(1)
    tested._answer_owed(1)
    assert told.count(NODE_CHANNEL) == 200
