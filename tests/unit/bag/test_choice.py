"""The topics that are recorded."""

import pytest
from fixtures.says import assert_says

from lcmtools.bag.choice import RecordedTopics
from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role
from lcmtools.names import Resolver

_NAMES = Resolver("/husky0")
_CHANNELS = ["/husky0/odometry", "/husky0/image", "/other", "EXAMPLE", "/husky0/_hidden"]
_GRAPH = Graph(
    (
        NodeInfo(
            "/husky0/driver",
            "1",
            "here",
            1,
            endpoints=(
                Endpoint("/husky0/odometry", Role.PUBLISHER),
                Endpoint("/other", Role.SUBSCRIBER),
                Endpoint("/husky0/image", Role.SERVICE),
            ),
        ),
    ),
    (),
    0,
)


@pytest.mark.parametrize(
    ("topics", "options", "wanted"),
    [
        ((), {}, _CHANNELS[:4]),
        ((), {"hidden": True}, _CHANNELS),
        (("odometry",), {}, ["/husky0/odometry"]),
        (("EXAMPLE", "/other"), {}, ["/other", "EXAMPLE"]),
        (("/husky0/*",), {}, _CHANNELS[:2]),
        (("/husky0/*",), {"hidden": True}, [*_CHANNELS[:2], "/husky0/_hidden"]),
        ((), {"exclude": ["**/image", "EXAMPLE"]}, ["/husky0/odometry", "/other"]),
        ((), {"nodes": ["driver"]}, ["/husky0/odometry", "/other"]),
        (("EXAMPLE",), {"nodes": ["driver"]}, ["/husky0/odometry", "/other", "EXAMPLE"]),
    ],
)
def test_topics_are_chosen_by_name_pattern_and_node(topics, options, wanted):
    choice = RecordedTopics(topics, _NAMES, **options)
    choice.update(_GRAPH)
    assert [channel for channel in _CHANNELS if choice.includes(channel)] == wanted


def test_the_protocol_of_announcements_is_never_among_the_messages():
    assert not RecordedTopics((), _NAMES, hidden=True).includes("/_lcmtools/node")


def test_topics_that_are_named_are_known_before_they_are_published():
    assert "/husky0/scan" in RecordedTopics(("scan",), _NAMES).update(Graph())


def test_a_node_that_is_not_there_is_named():
    choice = RecordedTopics((), _NAMES, nodes=["drivver", "/husky0/driver", "/*/d*"])
    (line,) = choice.silent(_GRAPH)
    assert_says(line, "no node", "drivver", "did you mean /husky0/driver?")
