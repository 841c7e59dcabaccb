"""Simulators, and the simulated time that stands still."""

import pytest

from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role, Staleness
from lcmtools.observe.simulators import pause_text

SECOND = 1_000_000_000
STEP = Endpoint("/sim/step", Role.SERVICE, ("sim_msgs/Step_Request",))


def _node(ticked, *ends):
    clock = Endpoint("/clock", Role.PUBLISHER, messages=3, last_time=round(ticked * SECOND))
    return NodeInfo(
        "/sim", "id", "host", 1, 50 * SECOND, endpoints=(clock, *ends), sent=100 * SECOND
    )


@pytest.mark.parametrize(
    ("node", "text"),
    [
        (_node(90, STEP), "the simulator /sim is paused: lcmtools sim resume"),
        (_node(90), "the simulated time, published by /sim, stands still"),
        (_node(0, STEP), "the simulator /sim is paused: lcmtools sim resume"),
        (_node(99.5, STEP), ""),
        (_node(90, STEP)._replace(stale=Staleness.ENDED), ""),
        (_node(0, STEP)._replace(start_time=99_500_000_000), ""),  # it has just been started
        (_node(90)._replace(endpoints=(STEP,)), ""),  # it follows the time of another one
    ],
)
def test_a_simulator_is_paused_when_its_clock_has_not_ticked_for_a_second(node, text):
    assert pause_text(Graph((node,), time=100 * SECOND)) == text
