"""A look goes on where a second leaves doubts; the signs themselves are in tests/doctor/cases."""

from dataclasses import replace

import pytest

from lcmtools.doctor.evidence import Evidence, SimulatedClock, Stream
from lcmtools.doctor.rules import in_doubt, shows_signs
from lcmtools.graph.model import Graph, NodeInfo, Staleness, Traffic

SEEN = Evidence("udpm://", graph=Graph(traffic=(Traffic("A", None, (), 1, 8, 0, 0),)), listened=1.0)


def test_what_is_well_is_looked_at_for_a_second_and_a_fault_for_longer():
    assert not in_doubt(SEEN)
    dead = NodeInfo("/dead", "d", "here", 1, stale=Staleness.ENDED)
    faulty = replace(SEEN, graph=SEEN.graph._replace(nodes=(dead,)))
    assert in_doubt(faulty)
    assert not shows_signs(faulty), "whoever chose the duration has chosen it"


def test_nobody_waits_for_an_empty_bus():
    assert not in_doubt(Evidence("udpm://"))


@pytest.mark.parametrize("is_back", [True, False])
def test_a_node_that_has_left_may_be_starting_again(is_back):
    node = NodeInfo("/talker", "1", "here", 7, sent=1)
    after = (node._replace(id="2"),) if is_back else ()
    evidence = Evidence("udpm://", before=Graph((node,)), graph=Graph(after), listened=0.7)
    assert shows_signs(evidence) != is_back


def test_of_a_clock_that_seldom_ticks_more_should_be_seen():
    seen = Evidence("udpm://", streams=(Stream("/clock", None, "sim", (1,)),), listened=0.7)
    assert shows_signs(seen)
    assert not shows_signs(replace(seen, clock=SimulatedClock("sim", 1.0)))
