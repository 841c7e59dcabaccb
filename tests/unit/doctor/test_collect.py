"""Nodes are requested to announce themselves until all senders have names and none is late."""

import os
import socket
from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import pytest

from lcmtools.doctor import brief, collect
from lcmtools.doctor.collect import _refreshed_graph, _without_departed
from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.listening import Listening
from lcmtools.doctor.memory import Memory
from lcmtools.graph.model import Graph, Node, Staleness, Traffic
from lcmtools.observe.reading.monitor import BusMonitor
from lcmtools.wire.packet import Sender

FAR, HERE = Sender("192.0.2.7", 4000), Sender("127.0.0.1", 4000)


class _Monitor:
    """A bus with one sender, whose node's answer comes after the request of this number."""

    def __init__(self, sender: Sender, answered: int) -> None:
        self.sender, self.answered, self.requests = sender, answered, 0

    def probe(self) -> None:
        self.requests += 1

    def packets(self, _: float) -> tuple[()]:
        return ()

    def graph(self) -> Graph:
        is_known = self.requests >= self.answered
        node = Node("/far", "f", "h", 1, sender=self.sender)
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
def test_requests_end_with_the_last_name(
    sender: Sender, answered: int, listen: float, requests: int
) -> None:
    monitor = _Monitor(sender, answered)
    _refreshed_graph(cast("BusMonitor", monitor), Listening(lambda _: ()), listen)
    assert monitor.requests == requests


class _LateNode(_Monitor):
    """A bus with a node of this computer that answers after so many seconds."""

    def __init__(self, pid: int, answered: float) -> None:
        super().__init__(HERE, 0)
        self.node = Node("/late", "l", socket.gethostname(), pid, stale=Staleness.HANGS)
        self.answered, self.waited = answered, 0.0

    def packets(self, seconds: float) -> tuple[()]:
        self.waited += seconds
        return ()

    def graph(self) -> Graph:
        stale = Staleness.NOT if self.waited >= self.answered else Staleness.HANGS
        return Graph((self.node._replace(stale=stale),))


@pytest.mark.parametrize(
    ("pid", "answered", "waited"),
    [
        pytest.param(os.getpid(), 0.01, 0.05, id="answers at once"),
        pytest.param(os.getpid(), 0.6, 0.75, id="waits for a processor"),
        pytest.param(os.getpid(), 99.0, 1.55, id="hangs"),
        pytest.param(2**22 + 1, 99.0, 0.05, id="has ended"),
    ],
)
def test_a_node_that_runs_is_given_time_to_answer(pid: int, answered: float, waited: float) -> None:
    monitor = _LateNode(pid, answered)
    _refreshed_graph(cast("BusMonitor", monitor), Listening(lambda _: ()), 1.0)
    assert monitor.waited == pytest.approx(waited)


@pytest.mark.parametrize(
    ("wanted", "is_enough", "taken", "listened"),
    [
        pytest.param(None, 1, [0.65], 0.7, id="brief"),
        pytest.param(None, 0, [0.65, 0.3], 1.0, id="goes on to the whole second"),
        pytest.param(2.0, 1, [2.0], 2.0, id="as long as was chosen"),
    ],
)
def test_a_look_is_brief_where_nobody_chose_its_length_and_that_is_enough(
    wanted: float | None,
    is_enough: int,
    taken: list[float],
    listened: float,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    parts: list[float] = []
    begin = SimpleNamespace(graph=Graph(), listening=None)
    monkeypatch.setattr(collect._Baseline, "now", lambda _: begin)
    monkeypatch.setattr(collect, "_receive", lambda _, __, seconds: parts.append(seconds))
    monkeypatch.setattr(collect, "_gather", lambda _, found, __, s: replace(found, listened=s))
    monkeypatch.setattr(brief, "is_enough", lambda _: is_enough)
    found = collect._observe(cast("BusMonitor", None), Evidence("udpm://"), wanted, Memory())
    assert parts == pytest.approx(taken)
    assert found.listened == pytest.approx(listened)


def test_messages_of_a_node_that_said_goodbye_are_no_plain_programs() -> None:
    stays, leaves, plain = (Sender("127.0.0.1", port) for port in (1, 2, 3))
    nodes = [Node(f"/{one.port}", str(one.port), "h", 1, sender=one) for one in (stays, leaves)]
    traffic = tuple(Traffic("/a", one, (), 1, 8, 0, 0) for one in (stays, leaves, plain))
    found = _without_departed(Graph((nodes[0],), traffic), before=Graph(tuple(nodes)))
    assert [seen.sender for seen in found.traffic] == [stays, plain]
