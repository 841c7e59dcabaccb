"""The node that a word on the command line means."""

import pytest

from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.graph.model import Graph, NodeInfo, Staleness
from lcmtools.observe.reading.find import find_node, find_nodes
from lcmtools.wire.packet import Sender

_GRAPH = Graph(
    (
        NodeInfo("/husky0/driver", "1", "h", 11),
        NodeInfo("/husky1/driver", "2", "h", 12),
        NodeInfo("/husky1/simple_controller", "3", "h", 12),
        NodeInfo("/talker", "4", "h", 13, stale=Staleness.ENDED),
        NodeInfo("/talker", "5", "h", 14),
        NodeInfo("/twin", "6", "h", 15),
        NodeInfo("/twin", "7", "h", 16),
        NodeInfo("/twin", "8", "ada", 13, sender=Sender("10.0.0.1", 40_000)),
    )
)


@pytest.mark.parametrize(
    ("word", "ids"),
    [
        ("/husky0/driver", ["1"]),
        ("husky0/driver", ["1"]),
        ("simple_controller", ["3"]),
        ("talker", ["5"]),
        ("twin", ["6", "7", "8"]),
        ("15", ["6"]),
        ("12", ["2", "3"]),
        ("h:15", ["6"]),
        ("ada:13", ["8"]),
        ("10.0.0.1:13", ["8"]),
    ],
)
def test_a_full_name_a_last_part_and_a_pid_mean_nodes(word, ids):
    assert [node.id for node in find_nodes(_GRAPH, word)] == ids
    assert find_node(_GRAPH, word).id == ids[0]


@pytest.mark.parametrize(
    ("word", "line"),
    [
        ("driver", "several nodes are named driver; write one of /husky0/driver, /husky1/driver"),
        ("talkr", "unknown node talkr; did you mean /talker?"),
        (
            "simple_controler",
            "unknown node simple_controler; did you mean /husky1/simple_controller?",
        ),
        (
            "/simple_controller",
            "unknown node /simple_controller; did you mean /husky1/simple_controller?",
        ),
        ("/husky1/drivr", "unknown node /husky1/drivr; did you mean /husky1/driver?"),
        ("99", "unknown node 99; lcmtools node list shows them"),
        ("zzzzzz", "unknown node zzzzzz; lcmtools node list shows them"),
    ],
)
def test_what_means_none_says_what_may_have_been_meant(word, line):
    with pytest.raises(LcmtoolsError) as caught:
        find_nodes(_GRAPH, word)
    assert str(caught.value) == line


def test_an_empty_name_is_wrong_usage():
    with pytest.raises(UsageError):
        find_nodes(_GRAPH, "")
