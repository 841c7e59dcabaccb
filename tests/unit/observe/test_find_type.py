"""Which topics are of a type."""

from lcmtools.graph.model import Endpoint, NodeInfo, Role, Topic, Traffic
from lcmtools.messages.registry import fingerprint, message_class
from lcmtools.observe.reading.find import is_of_type

_TWIST = fingerprint(message_class("geometry_msgs/Twist"))  # Accel has it too


def _topic(*, announced="", seen=None):
    endpoint = Endpoint("/a", Role.PUBLISHER, types=(announced,))
    publishers = ((NodeInfo("/node", "id", "host", 1), endpoint),) if announced else ()
    traffic = (Traffic("/a", None, (seen,), 1, 8, 0, 0),) if seen is not None else ()
    return Topic("/a", publishers, (), traffic, ())


def test_an_announced_type_counts():
    assert is_of_type(_topic(announced="geometry_msgs/Twist"), "geometry_msgs/Twist")
    assert not is_of_type(_topic(announced="geometry_msgs/Twist"), "std_msgs/String")
    assert not is_of_type(_topic(), "std_msgs/String")


def test_where_none_is_announced_every_type_of_the_fingerprint_counts():
    topic = _topic(seen=_TWIST)
    assert is_of_type(topic, "geometry_msgs/Twist")
    assert is_of_type(topic, "geometry_msgs/Accel")
    assert not is_of_type(_topic(seen=1), "geometry_msgs/Twist")


def test_an_announced_type_settles_what_a_fingerprint_means():
    topic = _topic(announced="geometry_msgs/Accel", seen=_TWIST)
    assert is_of_type(topic, "geometry_msgs/Accel")
    assert not is_of_type(topic, "geometry_msgs/Twist")


def test_what_comes_besides_the_announced_type_counts():
    topic = _topic(announced="std_msgs/String", seen=_TWIST)
    assert is_of_type(topic, "geometry_msgs/Twist")
