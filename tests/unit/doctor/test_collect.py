"""Nodes are requested to announce themselves until all senders have names and none is late."""

import os
import socket
from dataclasses import replace
from types import SimpleNamespace

import pytest

from lcmtools.doctor import collect
from lcmtools.doctor.collect import _refreshed_graph, _without_departed
from lcmtools.doctor.evidence import Evidence, derived
from lcmtools.doctor.listening import Listening
from lcmtools.doctor.memory import Memory
from lcmtools.graph.model import Graph, NodeInfo, Staleness, Traffic
from lcmtools.messages.codec import encode
from lcmtools.types.rosgraph_msgs import Clock
from lcmtools.wire.packet import Packet, Sender

FAR, HERE = Sender("192.0.2.7", 4000), Sender("127.0.0.1", 4000)


class _Monitor:
    """A bus with one sender, whose node's answer comes after the request of this number."""

    is_log: bool = False

    def __init__(self, sender, answered):
        self.sender, self.answered, self.requests = sender, answered, 0

    def probe(self):
        self.requests += 1

    def packets(self, _):
        return ()

    def graph(self):
        is_known = self.requests >= self.answered
        node = NodeInfo("/far", "f", "h", 1, sender=self.sender)
        traffic = (Traffic("/a", self.sender, (), 1, 8, 0, 0),)
        return Graph((node,) if is_known else (), traffic)


@pytest.mark.parametrize(
    ("sender", "answered", "listen", "requests"),
    [
        pytest.param(FAR, 1, 1.0, 1, id="answered at once"),
        pytest.param(FAR, 3, 1.0, 3, id="two answers were lost"),
        pytest.param(FAR, 99, 1.0, 5, id="a plain LCM program"),
        pytest.param(HERE, 99, 1.0, 1, id="no loss on this computer"),
        pytest.param(FAR, 1, 0.05, 0, id="too short a look"),
    ],
)
def test_requests_end_with_the_last_name(sender, answered, listen, requests):
    monitor = _Monitor(sender, answered)
    _refreshed_graph(monitor, Listening(lambda _: ()), listen)
    assert monitor.requests == requests


class _LateNode(_Monitor):
    """A bus with a node of this computer that answers after so many seconds."""

    def __init__(self, pid, answered, count=1):
        super().__init__(HERE, 0)
        self.count = count
        self.node = NodeInfo("/late", "l", socket.gethostname(), pid, stale=Staleness.HANGS)
        self.waited = 0.0
        self.needed = answered

    def packets(self, seconds):
        self.waited += seconds
        return ()

    def graph(self):
        stale = Staleness.NOT if self.waited >= self.needed else Staleness.HANGS
        return Graph((self.node._replace(stale=stale),) * self.count)


class _LateCounters(_LateNode):
    """The same, where the node was heard before and only its new counters are late."""

    def graph(self):
        return Graph((self.node._replace(stale=Staleness.NOT, sent=1 + (self.waited > 0.6)),))


def test_the_counters_of_a_busy_node_are_waited_for():
    monitor = _LateCounters(os.getpid(), 0.6)
    graph = _refreshed_graph(monitor, Listening(lambda _: ()), 1.0)
    assert [node.sent for node in graph.nodes] == [2]


def test_no_answer_is_waited_for_in_a_log():
    monitor = _LateCounters(os.getpid(), 99.0)
    monitor.is_log = True
    _refreshed_graph(monitor, Listening(lambda _: ()), 1.0)
    assert monitor.requests == 1


@pytest.mark.parametrize(
    ("pid", "answered", "waited"),
    [
        pytest.param(os.getpid(), 0.01, 0.05, id="answers at once"),
        pytest.param(os.getpid(), 0.6, 0.75, id="waits for a processor"),
        pytest.param(os.getpid(), 99.0, 1.55, id="hangs"),
        pytest.param(2**22 + 1, 99.0, 0.05, id="has ended"),
    ],
)
def test_a_node_that_runs_is_given_time_to_answer(pid, answered, waited):
    monitor = _LateNode(pid, answered)
    _refreshed_graph(monitor, Listening(lambda _: ()), 1.0)
    assert monitor.waited == pytest.approx(waited)


@pytest.mark.parametrize(
    ("wanted", "doubts", "taken", "listened"),
    [
        pytest.param(1.0, False, [1.0], 1.0, id="well"),
        pytest.param(1.0, True, [1.0, 2.5], 3.5, id="goes on"),
        pytest.param(0.1, True, [0.1], 0.1, id="too brief to go on"),
        pytest.param(4.0, True, [4.0], 4.0, id="long enough"),
    ],
)
def test_a_look_goes_on_once_if_it_is_in_doubt(
    wanted,
    doubts,
    taken,
    listened,
    monkeypatch,
):
    parts = []
    begin = SimpleNamespace(graph=Graph(), listening=None)
    monkeypatch.setattr(collect._Baseline, "now", lambda _: begin)
    monkeypatch.setattr(collect, "_receive", lambda _, __, seconds: parts.append(seconds))
    monkeypatch.setattr(collect, "_gather", lambda _, found, __, s: replace(found, listened=s))
    known = None, Evidence("udpm://"), wanted, Memory()
    found = collect._observe(*known, lambda _: doubts)
    assert parts == pytest.approx(taken)
    assert found.listened == pytest.approx(listened)


def test_messages_of_a_node_that_said_goodbye_are_no_plain_programs():
    stays, leaves, plain = (Sender("127.0.0.1", port) for port in (1, 2, 3))
    nodes = [NodeInfo(f"/{one.port}", str(one.port), "h", 1, sender=one) for one in (stays, leaves)]
    traffic = tuple(Traffic("/a", one, (), 1, 8, 0, 0) for one in (stays, leaves, plain))
    found = _without_departed(Graph((nodes[0],), traffic), before=Graph(tuple(nodes)))
    assert [seen.sender for seen in found.traffic] == [stays, plain]


def test_nodes_that_a_stranger_makes_up_are_given_none():
    monitor = _LateNode(os.getpid(), 99.0, count=1000)
    _refreshed_graph(monitor, Listening(lambda _: ()), 1.0)
    assert (monitor.requests, monitor.waited) == (1, pytest.approx(0.05))


def test_a_flood_of_channels_takes_little_memory_and_hides_no_other_one():
    listening = Listening(lambda _: ())
    for number in range(6000):
        listening.add_packet(Packet(f"/junk{number}", b"", number, FAR))
        listening.add_packet(Packet("/mine", b"", number, HERE))
        listening.add_packet(Packet("/clock", encode(Clock()), number, HERE))
    channels = {one.channel: one for one in listening.streams()}
    assert len(channels) == 2000
    assert len(channels["/mine"].times) == 5000
    assert len(listening.clock_ticks) == 5000


def test_functions_of_one_name_in_two_modules_derive_two_values():
    def of_module(name, value):
        def shares(_):
            return value

        shares.__module__ = name
        return derived(shares)

    evidence = Evidence("udpm://239.255.76.67:7667")
    one, other = of_module("a", 1), of_module("b", 2)
    assert [one(evidence), other(evidence), one(evidence)] == [1, 2, 1]
