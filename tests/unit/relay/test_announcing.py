"""Nodes of one bus as a relay announces them on the other one."""

from lcmtools.graph.builder import MOST_NODES
from lcmtools.graph.model import NodeInfo, RelayStep, Traffic
from lcmtools.graph.protocol import Announcement
from lcmtools.messages.registry import fingerprint
from lcmtools.relay.announcing import Announced
from lcmtools.relay.rules import Direction, Rules
from lcmtools.types.geometry_msgs import Twist

SECOND = 1_000_000_000


def test_an_announcement_tells_how_long_it_was_kept():
    ways = (Direction(Rules(), back=back) for back in (False, True))
    announced = Announced(RelayStep("r", "/relay", "0"), *ways, one_way=False)
    at_once = announced.convert(Announcement(NodeInfo("/far", "f", "robot", 7)), 9, SECOND)
    assert at_once.node.path == (RelayStep("r", "/relay", "0"),)
    (later,) = announced.recent(3 * SECOND)
    assert later.node.path == (RelayStep("r", "/relay", "0", kept=2 * SECOND),)
    assert announced.recent(5 * SECOND) == []


def test_a_stranger_who_makes_nodes_up_fills_no_memory():
    ways = (Direction(Rules(), back=back) for back in (False, True))
    announced = Announced(RelayStep("r", "/relay", "0"), *ways, one_way=False)
    for number in range(5000):
        announced.convert(Announcement(NodeInfo("/far", str(number), "ada", 7)), 9, SECOND)
    assert len(announced.recent(SECOND)) <= MOST_NODES
    announced.convert(Announcement(NodeInfo("/far", "large", "ada", 7)), 100 << 20, 2 * SECOND)
    assert [one.node.id for one in announced.recent(2 * SECOND)] == ["large"]


def test_what_a_relay_has_observed_gets_its_names_on_the_next_bus():
    rules = Rules(prefix="robot7", deny=["/secret"])
    ways = (Direction(rules, back=back) for back in (False, True))
    announced = Announced(RelayStep("r", "/relay", "0"), *ways, one_way=False)
    twist = fingerprint(Twist)
    observed = tuple(
        Traffic(channel, None, numbers, 1, 8, 1, 1)
        for channel, numbers in (("/odom", ()), ("/secret", ()), ("/speed", (twist,)))
    )
    node = NodeInfo("/far", "f", "ada", 7, observed=observed)
    passed = announced.convert(Announcement(node), 9, SECOND)
    assert [seen.channel for seen in passed.node.observed] == ["/robot7/odom"]
