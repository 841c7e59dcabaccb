"""The simulator that ``lcmtools sim`` calls."""

from contextlib import contextmanager

import pytest

from lcmtools.errors import LcmtoolsError
from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role, Staleness
from lcmtools.publish import simulator
from lcmtools.types import sim_msgs, std_srvs

LEADER = NodeInfo(
    "/sim",
    "1",
    "morse",
    1,
    endpoints=(
        Endpoint("/clock", Role.PUBLISHER, ("rosgraph_msgs/Clock",)),
        Endpoint("/sim/step", Role.SERVICE, ("sim_msgs/Step",)),
    ),
)
FOLLOWER = NodeInfo(
    "/sim_husky2",
    "2",
    "morse",
    2,
    endpoints=(Endpoint("/sim_husky2/step", Role.SERVICE, ("sim_msgs/Step",)),),
)
PLAYER = NodeInfo("/player", "3", "morse", 3, endpoints=LEADER.endpoints[:1])  # bag play --clock
LATE = LEADER._replace(stale=Staleness.HANGS, endpoints=())


class Bus:
    """A bus that is seen so, one look after the other; it keeps whom somebody called."""

    def __init__(self, *graphs):
        self.url = ""
        self.graphs = list(graphs)
        self.called = []

    def settle(self, *, foreign):
        """The state that is seen now."""
        del foreign
        return self.graphs.pop(0) if len(self.graphs) > 1 else self.graphs[0]

    def create_client(self, pair, service):
        """Of any service."""
        del pair
        self.called.append(service)
        return self

    def call(self, request, timeout):
        """Everything works."""
        del request, timeout
        response = std_srvs.Trigger.Response()
        response.success = True
        return response


@pytest.fixture
def ask(monkeypatch):
    def asked(name, *graphs):
        bus = Bus(*graphs)

        @contextmanager
        def found(*_):
            yield bus

        monkeypatch.setattr(simulator, "temporary_node", found)
        simulator.call_simulator(
            bus,
            name,
            "step",
            sim_msgs.Step,
            timeout=1.0,
        )
        return bus.called

    return asked


@pytest.mark.parametrize("name", [None, "sim", "/sim"])
def test_a_leader_that_answers_late_is_waited_for(ask, name):
    late = Graph(nodes=(LATE, FOLLOWER))
    complete = Graph(nodes=(LEADER, FOLLOWER))

    assert ask(name, late, complete) == ["/sim/step"]


def test_a_log_that_is_played_with_its_clock_is_not_taken_for_the_leader(ask):
    assert ask(None, Graph(nodes=(PLAYER, LEADER))) == ["/sim/step"]
    assert ask(None, Graph(nodes=(PLAYER, LEADER, FOLLOWER))) == ["/sim/step"]
    other = FOLLOWER._replace(name="/sim_husky3", id="4")
    with pytest.raises(LcmtoolsError, match="several simulators run"):
        ask(None, Graph(nodes=(PLAYER, FOLLOWER, other)))
    with pytest.raises(LcmtoolsError, match="/player is not a simulator"):
        ask("/player", Graph(nodes=(PLAYER, LEADER)))
