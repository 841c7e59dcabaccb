"""The words after a service's name: a type as ros2 wants it, or values as rosservice does."""

import pytest
from fixtures.says import raises_saying

from lcmtools.errors import LcmtoolsError, UnknownType, UsageError
from lcmtools.graph.model import Endpoint, NodeInfo, Role
from lcmtools.messages.registry import service_class
from lcmtools.observe.reading.find import OfferedService
from lcmtools.publish.calls import split_type


def _offered(kind):
    node = NodeInfo("/server", "1", "host", 1)
    return OfferedService("/it", ((node, Endpoint("/it", Role.SERVICE, (kind,) if kind else ())),))


@pytest.mark.parametrize(
    ("kind", "words", "values"),
    [
        ("std_srvs/SetBool", [], []),
        ("std_srvs/SetBool", ["data: true"], ["data: true"]),
        ("std_srvs/SetBool", ["std_srvs/SetBool", "true"], ["true"]),
        ("std_srvs/SetBool", ["std_srvs/srv/SetBool", "-1"], ["-1"]),
        ("std_srvs/SetBool", ["std_srvs.SetBool"], []),
        ("std_srvs/SetBool", ["SetBool", "true"], ["true"]),
        ("std_srvs/SetBool", ["hello.world"], ["hello.world"]),
        ("sim_msgs/Spawn", ["maps/yard"], ["maps/yard"]),
    ],
)
def test_a_type_is_told_from_a_value(kind, words, values):
    assert split_type(_offered(kind), words) == (service_class(kind), values)


def test_a_type_is_needed_where_none_is_announced():
    pair, values = split_type(_offered(""), ["std_srvs/Trigger"])
    assert (pair, values) == (service_class("std_srvs/Trigger"), [])
    with raises_saying(LcmtoolsError, "type", "/it", "not known"):
        split_type(_offered(""), ["true"])


def test_another_type_than_the_services_is_refused():
    with raises_saying(UsageError, "/it", "std_srvs/SetBool", "not std_srvs/Trigger"):
        split_type(_offered("std_srvs/SetBool"), ["std_srvs/Trigger"])
    with raises_saying(UnknownType, "service type", "'std_srvs/SetBol'"):
        split_type(_offered("std_srvs/SetBool"), ["std_srvs/SetBol"])


def test_a_type_that_is_not_known_here_is_named():
    with pytest.raises(LcmtoolsError, match=r"/it: .*'theirs/Thing'") as caught:
        split_type(_offered("theirs/Thing"), ["true"])
    assert caught.value.exit_code == 1
