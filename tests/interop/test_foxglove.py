"""MCAP files and a live bus of ours, decoded by Foxglove's own packages (npm), field for field."""

import json
import math
import shutil
import subprocess
from collections.abc import Mapping
from pathlib import Path

import pytest

from lcmtools import Node
from lcmtools.bag.ros_bags import McapFile
from lcmtools.bag.ros_types import RosTypes
from lcmtools.messages.codec import encode
from lcmtools.messages.fields import visible_fields
from lcmtools.messages.plain import to_plain
from lcmtools.messages.registry import message_class, type_names
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.types.geometry_msgs import Twist
from lcmtools.wire.packet import Packet

_SCRIPTS = Path(__file__).parent / "foxglove"
_TIME = 1_700_000_000_123_456_789


@pytest.fixture(scope="module")
def scripts(tmp_path_factory):
    """The folder of the scripts, with the packages that they need."""
    if not (shutil.which("node") and shutil.which("npm")):
        pytest.skip("node and npm are not installed")
    folder = tmp_path_factory.mktemp("foxglove")
    for file in _SCRIPTS.iterdir():
        shutil.copy(file, folder)
    install = ["npm", "ci", "--silent", "--no-audit", "--prefer-offline", "--fetch-retries=0"]
    if subprocess.run(install, cwd=folder, check=False).returncode:
        pytest.skip("npm cannot install Foxglove's packages")
    return folder


def _filled(name, count=0):
    """A message of a type with another value in every field."""
    message = message_class(name)()
    for number, part in enumerate(visible_fields(type(message)), count + 1):
        setattr(message, part.name, _values(part, list(part.dimensions), number))
    return message


def _values(part, sizes, number):
    if sizes:
        size = sizes[0] if isinstance(sizes[0], int) else 2
        return [_values(part, sizes[1:], number + place) for place in range(size)]
    if part.message_class:
        return _filled(part.type, number)
    if part.type == "string":
        return f"text {number} ä"
    if part.type == "bool":
        return bool(number % 2)
    return number + 0.25 if part.type.startswith("float") else number


def _as_foxglove_has_it(plain, encoding, name=""):
    if encoding == "ros1" and name in ("std_msgs/Time", "std_msgs/Duration"):
        return {"data": plain}  # ROS 1's message, which has a time
    if isinstance(plain, Mapping):
        names = {
            key.lower() if encoding == "cdr" else key: value
            for key, value in plain.items()
            if not (encoding == "cdr" and key == "seq")
        }
        return {key: _as_foxglove_has_it(value, encoding) for key, value in names.items()}
    return (
        [_as_foxglove_has_it(one, encoding) for one in plain] if isinstance(plain, list) else plain
    )


def _same(found, wanted):
    """Return whether values are equal, but for the names of nanoseconds."""
    if isinstance(wanted, Mapping) and isinstance(found, Mapping):
        found = {"nsec" if name == "nanosec" else name: one for name, one in found.items()}
        wanted = {"nsec" if name == "nanosec" else name: one for name, one in wanted.items()}
        return found.keys() == wanted.keys() and all(
            _same(found[name], one) for name, one in wanted.items()
        )
    if isinstance(wanted, list) and isinstance(found, list):
        return len(found) == len(wanted) and all(map(_same, found, wanted))
    if isinstance(found, str) and isinstance(wanted, int):  # 64 bits
        return int(found) == wanted
    return math.isclose(found, wanted) if isinstance(wanted, float) else found == wanted


@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
def test_every_type_is_decoded_field_for_field(encoding, scripts, tmp_path):
    messages = {name: _filled(name) for name in type_names()}
    path = tmp_path / "a.mcap"
    with McapFile(path, encoding) as file:
        for place, (name, message) in enumerate(messages.items()):
            packet = Packet(f"/{name}", encode(message), _TIME + place)
            file.add(packet, Decoder(lambda _, name=name: (name,)))
    command = ["node", scripts / "decode.mjs", path]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    rows = [json.loads(line) for line in run.stdout.splitlines()]
    assert [row["topic"] for row in rows] == [f"/{name}" for name in messages]
    assert [int(row["time"]) for row in rows] == [_TIME + place for place in range(len(rows))]
    for row, (name, message) in zip(rows, messages.items(), strict=True):
        wanted = _as_foxglove_has_it(to_plain(message), encoding, name)
        assert _same(row["message"], wanted), (row, wanted)


@pytest.fixture
def connect(start, bus_url, lcmtools_path, scripts):
    """``connect({topic: ...}, options=["--allow-publish"])``: a client that publishes these."""

    def run(*published, options=()):
        server = start(lcmtools_path, "foxglove", "--port", "0", *options, LCM_DEFAULT_URL=bus_url)
        url = server.wait_for("in Foxglove").partition(" connection to ")[2].split()[0]
        return start("node", str(scripts / "client.mjs"), url, *map(json.dumps, published))

    return run


def test_every_type_of_a_bus_is_decoded_field_for_field(connect, start_node, wait_until):
    messages = {f"/{name}": _filled(name) for name in type_names()}
    node = start_node(lambda: Node("all_types")).node
    publishers = {topic: node.create_publisher(type(one), topic) for topic, one in messages.items()}
    client = connect()
    for topic, publisher in publishers.items():
        wait_until(publisher.subscriber_count)
        publisher.publish(messages[topic])
        row = json.loads(client.wait_for('"event":"message"'))
        wanted = _as_foxglove_has_it(to_plain(messages[topic]), "ros1", topic[1:])
        assert row["topic"] == topic
        assert _same(row["message"], wanted), (row, wanted)


@pytest.mark.parametrize("encoding", ["json", "ros1"])
def test_a_client_publishes_where_it_may(encoding, connect, start_node, wait_until):
    got = []
    node = start_node(lambda: Node("robot")).node
    node.create_subscription(Twist, "/cmd", lambda message: got.append(message.linear.x))
    connect(_twist("/cmd", encoding), options=("--allow-publish", "/cmd"))
    wait_until(lambda: got)
    assert set(got) == {0.5}


def test_a_client_publishes_nothing_by_default(connect, start_node):
    got = []
    start_node(lambda: Node("robot")).node.create_subscription(Twist, "/cmd", got.append)
    client = connect(_twist("/cmd", "json"))
    assert "clientPublish" not in client.wait_for('"event":"info"')
    client.wait_for('"event":"status"')
    assert not got


def _twist(topic, encoding):
    zero = {"x": 0, "y": 0, "z": 0}
    message = {"linear": {**zero, "x": 0.5}, "angular": zero}
    wish = {"topic": topic, "schemaName": "geometry_msgs/Twist", "encoding": encoding}
    if encoding == "ros1":
        wish["definition"] = RosTypes(1).schema(Twist).text.decode()
    return {**wish, "message": message}
