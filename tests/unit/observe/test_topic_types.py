"""The types of a topic, in lists and graphs."""

import pytest

from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role, Traffic
from lcmtools.messages.registry import fingerprint
from lcmtools.observe.reports.describe import type_text
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.std_msgs import String
from lcmtools.wire.packet import Sender

_PLAIN = Sender("127.0.0.1", 50_000)
_UNKNOWN = 1


@pytest.mark.parametrize(
    ("announced", "sent", "text"),
    [
        pytest.param("", [], "unknown type", id="nothing known"),
        pytest.param("", [fingerprint(String)], "std_msgs/String", id="as it is sent"),
        pytest.param(
            "", [fingerprint(Twist)], "geometry_msgs/Twist (one of 2)", id="equal fields, as sent"
        ),
        pytest.param("std_msgs/String", [], "std_msgs/String", id="as it is announced"),
        pytest.param("std_msgs/String", [fingerprint(String)], "std_msgs/String", id="the same"),
        pytest.param("own/Text", [fingerprint(String)], "own/Text", id="equal fields"),
        pytest.param(
            "std_msgs/String",
            [fingerprint(Twist), _UNKNOWN],
            "std_msgs/String, geometry_msgs/Twist (one of 2), unknown type",
            id="several",
        ),
    ],
)
def test_all_types_are_named(announced, sent, text):
    ends = (Endpoint("/a", Role.SUBSCRIBER, (announced,), (fingerprint(String),)),)
    node = NodeInfo("/ear", "e", "h", 1, endpoints=ends if announced else ())
    traffic = (Traffic("/a", _PLAIN, tuple(sent), len(sent), 8, 0, 0),)
    assert type_text(Graph((node,), traffic).topic("/a")) == text
