"""Types and messages as Foxglove reads them."""

import pytest

from lcmtools.errors import DecodeError
from lcmtools.foxglove.schemas import JSON, ROS1, Schemas
from lcmtools.messages.codec import encode
from lcmtools.messages.registry import message_class, type_names
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import LaserScan


def test_every_shipped_type_is_one_of_ros():
    schemas = Schemas()
    for name in type_names():
        encoding, schema = schemas.of(message_class(name))
        assert (encoding, schema.name, schema.form) == (ROS1, name, "ros1msg")


@pytest.mark.parametrize("encoding", [ROS1, JSON])
def test_a_client_s_message_is_read(encoding):
    schemas, twist = Schemas(), Twist()
    twist.linear.x, twist.angular.z = 0.5, -0.25
    data = schemas.write(twist)
    if encoding == JSON:
        data = b'{"linear": {"x": 0.5}, "angular": {"z": -0.25}}'
    assert encode(schemas.read(Twist, encoding, data)) == encode(twist)


@pytest.mark.parametrize(
    ("encoding", "data", "said"),
    [
        (ROS1, b"\x01", "1 bytes are not a sensor_msgs/LaserScan"),
        (JSON, b"{", "no sensor_msgs/LaserScan: Expecting"),
        (JSON, b'{"rangs": []}', "no field 'rangs'"),
        (JSON, b"\xff", "no sensor_msgs/LaserScan"),
        ("cdr", b"", "messages in 'cdr'; known: json, ros1"),
    ],
)
def test_rubbish_of_a_client_is_refused(encoding, data, said):
    with pytest.raises(DecodeError, match=said):
        Schemas().read(LaserScan, encoding, data)


def test_a_type_that_ros_cannot_say_is_json(odd):
    schemas, tree = Schemas(), odd.Tree()
    tree.children, tree.children_length = [odd.Tree()], 1
    tree.children[0].value = 7
    for _ in range(2):
        encoding, schema = schemas.of(odd.Tree)
        assert (encoding, schema.name, schema.form) == (JSON, "odd/Tree", "jsonschema")
    assert encode(schemas.read(odd.Tree, encoding, schemas.write(tree))) == encode(tree)
