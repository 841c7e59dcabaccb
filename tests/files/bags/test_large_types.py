"""Types for which rosbags would write code for hours: left out, with the reason, and named."""

import pytest
from fixtures.limits import cpu_limit
from mcap.writer import Writer

from lcmtools.bag.ros_types import RosTypes
from lcmtools.errors import DecodeError
from lcmtools.messages.registry import Registry
from lcmtools.packages.user_types import UserTypes

LINE = "=" * 80
INNER = f"\n{LINE}\nMSG: a/B\nint32 x\nint32 y\n"
DOUBLED = "a/B0 a\na/B0 b\n" + "".join(
    f"{LINE}\nMSG: a/B{n}\na/B{n + 1} a\na/B{n + 1} b\n" for n in range(30)
)
LARGE = {
    "many fields": "".join(f"int32 a{n}\n" for n in range(6000)),
    "an array of messages": f"B[100000] b{INNER}",
    "an array of text": "string[100000] b",
    "messages that double": f"{DOUBLED}{LINE}\nMSG: a/B30\nint32 x\n",
}


def write_mcap(path, definition):
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start("ros2")
        for topic, text in (("/large", definition), ("/good", "int32 x")):  # both have 4 bytes
            schema = writer.register_schema(f"a/msg/T{topic[1:]}", "ros2msg", text.encode())
            channel = writer.register_channel(topic, "cdr", schema)
            writer.add_message(channel, 1, b"\0\1\0\0" + bytes(4), 1)
        writer.finish()


@pytest.mark.parametrize("definition", LARGE.values(), ids=LARGE)
def test_a_bag_with_such_a_type_is_imported_without_it(definition, cli, tmp_path):
    write_mcap(tmp_path / "a.mcap", definition)
    with cpu_limit():
        result = cli("bag", "import", str(tmp_path / "a.mcap"), str(tmp_path / "a.lcmlog"))
    assert "a/Tlarge has more than 5000 fields and elements of fixed arrays" in result.err, result
    assert "/good" in cli("bag", "info", str(tmp_path / "a.lcmlog")).out


def test_a_long_definition_is_not_read(cli, tmp_path):
    write_mcap(tmp_path / "a.mcap", "int32 x\n" + "#" * 1_000_000)
    result = cli("bag", "import", str(tmp_path / "a.mcap"), str(tmp_path / "a.lcmlog"))
    assert "its definition has more than 1000000 characters" in result.err


def test_large_arrays_of_numbers_are_imported(cli, tmp_path):
    write_mcap(tmp_path / "a.mcap", "uint8[1000000] x")
    result = cli("bag", "import", str(tmp_path / "a.mcap"), str(tmp_path / "a.lcmlog"))
    assert "more than 5000" not in result.err


def own_class(tmp_path, text):
    (tmp_path / "T.lcm").write_text(text)
    environment = {"LCMTOOLS_TYPE_PATH": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path / "cache")}
    types = UserTypes(environment, [], {})
    return Registry([], lambda: types).message_class("T")


def test_such_a_type_is_not_exported(tmp_path):
    kind = own_class(tmp_path, "struct T { string x[100000]; }")
    with cpu_limit(), pytest.raises(DecodeError, match="has more than 5000 fields"):
        RosTypes(2).serialize(kind())
