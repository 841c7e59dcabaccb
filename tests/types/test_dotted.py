"""Types in packages within packages, and with names that formats of others use themselves."""

import numpy as np  # noqa: F401 - it can be loaded once only, and commands forget modules
import pytest

from lcmtools.bag.ros_types import RosTypes, ros_name
from lcmtools.errors import DecodeError
from lcmtools.foxglove.schemas import ROS1, Schemas
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.registry import message_class
from lcmtools.types.std_msgs import String

ODD = ["acme.sense/ping", "acme/flat", "class.def/None", "class.def/list", "class.def/self"]


@pytest.mark.parametrize("form", ["mcap", "mcap-ros1", "ros1", "ros2"])
@pytest.mark.parametrize("name", ODD)
def test_they_are_exported(name, form, family, log_of, cli, tmp_path):
    family("dotted")
    log, out = log_of("ODD", encode(message_class(name)())), str(tmp_path / "out")
    result = cli("bag", "export", log, out, "--format", form)
    assert result.code == 0, result
    assert f"{out}: 1 message" in result.out


@pytest.mark.parametrize("name", ODD)
def test_foxglove_has_them(name, family):
    family("dotted")
    cls = message_class(name)
    schemas, message = Schemas(), decode(cls, encode(cls()))
    encoding, schema = schemas.of(type(message))
    assert encoding == ROS1
    assert schema.name == ros_name(type(message)).replace("/msg/", "/")
    assert "." not in schema.name
    assert schemas.read(type(message), ROS1, schemas.write(message)) == message


def test_one_that_the_library_of_ros_cannot_read_does_not_cost_the_others(family, monkeypatch):
    family("dotted")
    types = RosTypes(2)
    register = types.store.register

    def refuse(definitions):
        if "acme/msg/flat" in definitions:
            raise SyntaxError("invalid syntax")
        register(definitions)

    monkeypatch.setattr(types.store, "register", refuse)
    with pytest.raises(DecodeError, match="cannot read acme/msg/flat: invalid syntax"):
        types.ros_type(message_class("acme/flat"))
    assert types.ros_type(message_class("acme.sense/ping")).name == "acme_sense/msg/ping"
    assert types.ros_type(String).name == "std_msgs/msg/String"
