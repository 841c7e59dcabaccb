"""Simulators and publishers of simulated time: most nodes of either kind are both, but not all."""

import pytest

from lcmtools.clock import CLOCK_TOPIC
from lcmtools.graph.model import Endpoint, Graph, Node, Role, Staleness, Traffic
from lcmtools.observe.simulators import (
    has_simulated_time,
    is_simulator,
    publishes_time,
    simulators,
)

CLOCK = Endpoint(CLOCK_TOPIC, Role.PUBLISHER, ("rosgraph_msgs/Clock",))
STEP = Endpoint("/sim/step", Role.SERVICE, ("sim_msgs/Step",))


def node(*endpoints: Endpoint, name: str = "/n", stale: Staleness = Staleness.NOT) -> Node:
    return Node(name, name, "here", 1, endpoints=endpoints, stale=stale)


@pytest.mark.parametrize(
    ("endpoints", "simulates", "keeps_time"),
    [
        pytest.param((CLOCK, STEP), True, True, id="simulator"),
        pytest.param((STEP,), True, False, id="simulator that follows another one"),
        pytest.param((CLOCK,), False, True, id="bag play --clock"),
        pytest.param((CLOCK._replace(role=Role.SUBSCRIBER),), False, False, id="on its time"),
        pytest.param((STEP._replace(role=Role.CLIENT),), False, False, id="caller"),
        pytest.param((), False, False, id="nothing"),
        *(
            pytest.param((STEP._replace(types=(f"sim_msgs/{name}",)),), True, False, id=name)
            for name in ("GetState", "SetPose", "SetRate")
        ),
    ],
)
def test_a_simulator_has_services_and_a_publisher_of_time_the_clock(
    endpoints: tuple[Endpoint, ...],
    simulates: bool,  # noqa: FBT001 - of a table
    keeps_time: bool,  # noqa: FBT001
) -> None:
    assert is_simulator(node(*endpoints)) == simulates
    assert publishes_time(node(*endpoints)) == keeps_time


def test_only_living_simulators_are_found() -> None:
    sim, player = node(STEP, name="/sim"), node(CLOCK, name="/player")
    dead = node(STEP, name="/dead", stale=Staleness.ENDED)
    assert simulators(Graph((sim, player, dead))) == [sim]


def test_time_is_simulated_where_a_living_node_or_a_program_publishes_the_clock() -> None:
    assert has_simulated_time(Graph((node(CLOCK),)))
    assert has_simulated_time(Graph((), (Traffic(CLOCK_TOPIC, None, (), 1, 8, 0, 0),)))
    assert not has_simulated_time(Graph((node(CLOCK, stale=Staleness.ENDED),)))
    assert not has_simulated_time(Graph((node(STEP),)))
