"""ROS's definitions of a workspace: its std_msgs, and the reasons why a type is missing."""

import pytest
from fixtures.says import raises_saying

from lcmtools.errors import LcmtoolsError
from lcmtools.messages.registry import Registry
from lcmtools.messages.type_source import TypeSource
from lcmtools.packages.user_types import UserTypes
from lcmtools.types.fingerprints import FINGERPRINTS

# Those of https://github.com/ros/std_msgs, whose Time and Duration hold the primitives.
STD_MSGS = {
    "Time": "time data",
    "Duration": "duration data\n",
    "Header": "uint32 seq\n#Two-integer timestamp\ntime stamp\n#Frame\nstring frame_id",
    "String": "string data",
    "ColorRGBA": "float32 r\nfloat32 g\nfloat32 b\nfloat32 a",
    "UInt8": "uint8 data",
}
OWN = {
    "Stamped": "Header header\nfloat64 x",
    "Timed": "time a\nstd_msgs/Time b\nduration c\nstd_msgs/Duration[] d",
    "Name": "std_msgs/String name",
}


@pytest.fixture
def folder(tmp_path):
    """A folder with the packages std_msgs and p."""
    for package, types in (("std_msgs", STD_MSGS), ("p", OWN)):
        (tmp_path / package / "msg").mkdir(parents=True)
        for name, text in types.items():
            (tmp_path / package / "msg" / f"{name}.msg").write_text(text)
    return tmp_path


def registry(folder):
    environment = {"LCMTOOLS_TYPE_PATH": str(folder), "XDG_CACHE_HOME": str(folder / "cache")}
    types = UserTypes(environment, [], FINGERPRINTS)
    return Registry([TypeSource("lcmtools.types", FINGERPRINTS)], lambda: types)


def test_types_with_headers_and_times_can_be_used_beside_ros_own_std_msgs(folder):
    known = registry(folder)
    assert known.problems() == []
    stamped = known.message_class("p/Stamped")()
    stamped.header.stamp.sec = 7
    assert type(stamped).decode(stamped.encode()).header.stamp.sec == 7
    assert [type(known.message_class(f"p/{name}")()).__name__ for name in OWN] == list(OWN)


@pytest.mark.parametrize("name", STD_MSGS)
def test_ros_own_std_msgs_are_the_shipped_types_on_the_wire(folder, name):
    message = registry(folder).message_class(f"std_msgs/{name}")
    assert message._get_packed_fingerprint() == FINGERPRINTS[f"std_msgs/{name}"].to_bytes(8, "big")


@pytest.mark.parametrize(
    ("files", "parts"),
    [
        ({"Inner": "int8 a\nint x"}, ("Inner.msg:2", "unknown type 'int'")),
        ({"Inner": "int8 a=900"}, ("Inner.msg:1", "900 does not fit")),
        ({"Inner": "Deeper a", "Deeper": "int x"}, ("Deeper.msg:1", "unknown type 'int'")),
        ({}, ("Outer.msg:1", "unknown type 'Inner'")),
    ],
    ids=["unknown", "constant", "nested", "missing"],
)
def test_reason_for_a_missing_type_is_its_first_cause(folder, files, parts):
    for name, text in {**files, "Outer": "Inner inner"}.items():
        (folder / "p" / "msg" / f"{name}.msg").write_text(text)
    with raises_saying(LcmtoolsError, *parts):
        registry(folder).message_class("p/Outer")


def test_file_to_be_named_is_a_msg_file(folder):
    (folder / "p" / "msg" / "Far.msg").write_text("elsewhere_msgs/Thingamabob x")
    parts = ("Far.msg:1", "'elsewhere_msgs/Thingamabob'", "name the folder of its .msg file too")
    with raises_saying(LcmtoolsError, *parts):
        registry(folder).message_class("p/Far")
