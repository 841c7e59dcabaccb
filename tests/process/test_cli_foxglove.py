"""foxglove: what a client of its protocol gets and may do; tests/interop has Foxglove's own."""

import json
import struct
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import pytest
from fixtures.programs import Program
from fixtures.says import assert_line
from websockets.sync.client import ClientConnection, connect

from lcmtools import Node
from lcmtools.foxglove.schemas import Schemas
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.std_msgs import String

Start = Callable[..., Any]


@dataclass
class Client:
    """A connection, and what has come."""

    socket: ClientConnection
    heard: list[dict[str, Any]] = field(default_factory=list)

    def send(self, op: str, **values: object) -> None:
        """Send an operation."""
        self.socket.send(json.dumps({"op": op, **values}))

    def wait(self, found: Callable[[dict[str, Any]], object]) -> dict[str, Any]:
        """Return the first that fits, of what has come and what comes."""
        while True:
            for one in self.heard:
                if found(one):
                    return one
            self.heard.append(_read(self.socket.recv(timeout=40)))

    def subscribe(self, topic: str) -> dict[str, Any]:
        """Subscribe to a channel as soon as it is offered; return its description."""
        channel: dict[str, Any] = {}

        def offers(one: dict[str, Any]) -> bool:
            offered = one.get("channels", []) if one.get("op") == "advertise" else []
            channel.update(next((o for o in offered if o["topic"] == topic), {}))
            return bool(channel)

        self.wait(offers)
        wish = {"id": channel["id"], "channelId": channel["id"]}
        self.send("subscribe", subscriptions=[wish])
        return channel

    def message(self, channel: dict[str, Any]) -> bytes:
        """Return the payload of the first message of a channel."""
        found = self.wait(lambda one: one.get("channel") == channel["id"])
        payload: bytes = found["payload"]
        return payload

    def publish(self, topic: str, message: object) -> None:
        """Publish a Twist as JSON."""
        described = {
            "id": 1,
            "topic": topic,
            "encoding": "json",
            "schemaName": "geometry_msgs/Twist",
        }
        self.send("advertise", channels=[described])
        self.socket.send(struct.pack("<BI", 1, 1) + json.dumps(message).encode())


def _read(frame: str | bytes) -> dict[str, Any]:
    if isinstance(frame, str):
        found: dict[str, Any] = json.loads(frame)
        return found
    kind, channel, _ = struct.unpack_from("<BIQ", frame)
    return {"channel": channel, "payload": frame[13:]} if kind == 1 else {}


@pytest.fixture
def serve(start: Start, bus_url: str, lcmtools_path: str) -> Callable[..., tuple[Program, str]]:
    """``serve("--allow-publish")``: the command, and its address."""

    def run(*words: str) -> tuple[Program, str]:
        program = start(lcmtools_path, "foxglove", "--port", "0", *words, LCM_DEFAULT_URL=bus_url)
        said = program.wait_for("in Foxglove")
        return program, said.partition(" connection to ")[2].split()[0]

    return run


@contextmanager
def _client(url: str) -> Iterator[Client]:
    with connect(url, subprotocols=["foxglove.sdk.v1"]) as socket:  # type: ignore[list-item]
        yield Client(socket)


def _of_ros(payload: bytes, cls: Any) -> Any:
    return Schemas().read(cls, "ros1", payload)


def test_a_latched_message_comes_to_each_client(
    serve: Start, start_node: Start, wait_until: Start
) -> None:
    node = start_node(lambda: Node("mapper")).node
    publisher = node.create_publisher(String, "/map_name")
    publisher.is_latched = True
    message = String()
    message.data = "cellar"
    _, url = serve()
    wait_until(publisher.subscriber_count)
    publisher.publish(message)
    for _ in range(2):
        with _client(url) as client:
            channel = client.subscribe("/map_name")
            assert (channel["encoding"], channel["schemaName"]) == ("ros1", "std_msgs/String")
            assert _of_ros(client.message(channel), String).data == "cellar"


def test_the_graph_is_drawn_and_excluded_topics_are_not_offered(
    serve: Start, start_node: Start
) -> None:
    node = start_node(lambda: Node("driver")).node
    for topic in ("/cmd", "/secret/cmd"):
        node.create_publisher(Twist, topic)
    program, url = serve("--exclude", "/secret/**")
    with _client(url) as client:
        client.send("subscribeConnectionGraph")
        found = client.wait(lambda one: one.get("publishedTopics"))
        assert {"name": "/cmd", "publisherIds": ["/driver"]} in found["publishedTopics"]
        client.subscribe("/cmd")
        offered = [c["topic"] for one in client.heard for c in one.get("channels", [])]
        assert "/secret/cmd" not in offered
        client.send("unsubscribeConnectionGraph")
        client.subscribe("/rosout")
    assert len(program.lines) == 1, program.output  # it has said its address


def test_a_client_publishes_only_where_it_may(
    serve: Start, start_node: Start, wait_until: Start
) -> None:
    got: list[tuple[str, float]] = []
    node = start_node(lambda: Node("robot")).node
    for topic in ("/cmd", "/other"):
        node.create_subscription(
            Twist, topic, lambda message, topic=topic: got.append((topic, message.linear.x))
        )
    program, url = serve("--allow-publish", "/cmd")
    with _client(url) as client:
        assert "clientPublish" in client.wait(lambda one: "capabilities" in one)["capabilities"]
        client.publish("/other", {"linear": {"x": 1}})
        program.wait_for("cannot publish on /other: it is not allowed; --allow-publish /other")
    with _client(url) as client:
        client.publish("/cmd", {"linear": {"y": "fast"}})
        program.wait_for("a message for /cmd is not published: no geometry_msgs/Twist")
        client.subscribe("/cmd")
        client.socket.send(struct.pack("<BI", 1, 1) + b'{"linear": {"x": 2}}')
        wait_until(lambda: got)
    assert got == [("/cmd", 2.0)]


def test_nobody_publishes_by_default(serve: Start) -> None:
    _, url = serve()
    with _client(url) as client:
        assert "clientPublish" not in client.wait(lambda one: "capabilities" in one)["capabilities"]
        client.publish("/cmd", {"linear": {"x": 1}})
        said = client.wait(lambda one: one.get("op") == "status")["message"]
        assert "publish" in said.lower()


def test_a_script_reads_the_address(start: Start, bus_url: str, lcmtools_path: str) -> None:
    words = ("foxglove", "--port", "0", "--json")
    program = start(lcmtools_path, *words, LCM_DEFAULT_URL=bus_url)
    program.wait_for("}")
    with _client(json.loads("".join(program.lines))["address"]) as client:
        assert client.wait(lambda one: one.get("op") == "serverInfo")


def test_a_port_that_is_taken_is_an_error(serve: Start, cli: Start, bus_url: str) -> None:
    _, url = serve()
    port = url.rpartition(":")[2]
    result = cli("foxglove", "--port", port, env={"LCM_DEFAULT_URL": bus_url})
    said = f"lcmtools foxglove: cannot listen at 127.0.0.1:{port}: Address already in use"
    assert (result.code, result.err) == (1, f"{said}; --port N chooses another port\n")


@pytest.mark.parametrize("missing", ["foxglove", "rosbags.typesys"])
def test_a_missing_extra_is_named(
    cli: Start, bus_url: str, monkeypatch: pytest.MonkeyPatch, missing: str
) -> None:
    import sys

    monkeypatch.setitem(sys.modules, missing, None)
    result = cli("foxglove", env={"LCM_DEFAULT_URL": bus_url})
    assert (result.code, result.err.count("\n")) == (3, 1)
    install = "pip install 'lcmtools-robotics[foxglove]'\n"
    assert_line(result.err, "lcmtools foxglove: ", "extra 'foxglove' (", install)
