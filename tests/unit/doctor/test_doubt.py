"""A look goes on where a second leaves doubts."""

from dataclasses import replace

import pytest
from fixtures.judging import HEALTHY, NOW, SECOND, node, sub

from lcmtools.doctor.doubt import in_doubt, shows_signs
from lcmtools.doctor.evidence import Evidence, SimulatedClock, Stream
from lcmtools.graph.model import Endpoint, Graph, Node, Role, Staleness


def test_what_is_well_is_looked_at_for_a_second_and_a_fault_for_longer():
    assert not in_doubt(HEALTHY)
    dead = node("/dead", sub("/a"), stale=Staleness.ENDED)
    faulty = replace(HEALTHY, graph=Graph((dead,), HEALTHY.graph.traffic, NOW))
    assert in_doubt(faulty)
    assert not shows_signs(faulty), "whoever chose the duration has chosen it"


def test_nobody_waits_for_an_empty_bus():
    assert not in_doubt(replace(HEALTHY, graph=Graph(), before=Graph()))


@pytest.mark.parametrize("is_back", [True, False])
def test_a_node_that_has_left_may_be_starting_again(is_back):
    node = Node("/talker", "1", "here", 7, sent=1)
    after = (node._replace(id="2"),) if is_back else ()
    evidence = Evidence("udpm://", before=Graph((node,)), graph=Graph(after), listened=0.7)
    assert shows_signs(evidence) != is_back


def test_of_publishers_of_one_topic_all_should_be_seen():
    end = Endpoint("/cmd", Role.PUBLISHER, messages=5, last_time=SECOND)
    nodes = tuple(Node(f"/{n}", n, "here", 7, endpoints=(end,), sent=2 * SECOND) for n in "ab")
    streams = tuple(Stream("/cmd", None, node.name, (1, 2)) for node in nodes)
    seen = Evidence("udpm://", graph=Graph(nodes), streams=streams, listened=0.7)
    assert not shows_signs(seen)
    assert shows_signs(replace(seen, streams=streams[:1]))


def test_of_a_clock_that_seldom_ticks_more_should_be_seen():
    streams = (Stream("/clock", None, "sim", (1,)),)
    seen = Evidence("udpm://", streams=streams, listened=0.7)
    assert shows_signs(seen)
    assert not shows_signs(replace(seen, clock=SimulatedClock("sim", 1.0)))
