"""foxglove: what a client of its protocol gets and may do; tests/interop has Foxglove's own."""

import json
import signal
import socket
import struct
import sys
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from fixtures.says import assert_line
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from lcmtools import Node
from lcmtools.foxglove.schemas import Schemas
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.std_msgs import String


@dataclass
class Client:
    """A connection, and what has come."""

    socket: ClientConnection
    heard: list[dict[str, Any]] = field(default_factory=list)

    def send(self, op, **values):
        """Send an operation."""
        self.socket.send(json.dumps({"op": op, **values}))

    def wait(self, found):
        """Return the first that fits, of what has come and what comes."""
        while True:
            for one in self.heard:
                if found(one):
                    return one
            self.heard.append(_read(self.socket.recv(timeout=40)))

    def subscribe(self, topic):
        """Subscribe to a channel as soon as it is offered; return its description."""
        channel = {}

        def offers(one):
            offered = one.get("channels", []) if one.get("op") == "advertise" else []
            channel.update(next((o for o in offered if o["topic"] == topic), {}))
            return bool(channel)

        self.wait(offers)
        wish = {"id": channel["id"], "channelId": channel["id"]}
        self.send("subscribe", subscriptions=[wish])
        return channel

    def message(self, channel):
        """Return the payload of the first message of a channel."""
        found = self.wait(lambda one: one.get("channel") == channel["id"])
        payload = found["payload"]
        return payload

    def publish(self, topic, message):
        """Publish a Twist as JSON."""
        described = {
            "id": 1,
            "topic": topic,
            "encoding": "json",
            "schemaName": "geometry_msgs/Twist",
        }
        self.send("advertise", channels=[described])
        self.socket.send(struct.pack("<BI", 1, 1) + json.dumps(message).encode())


def _read(frame):
    if isinstance(frame, str):
        found = json.loads(frame)
        return found
    kind, channel, _ = struct.unpack_from("<BIQ", frame)
    return {"channel": channel, "payload": frame[13:]} if kind == 1 else {}


@pytest.fixture
def serve(start, bus_url, lcmtools_path):
    """``serve("--allow-publish")``: the command, and its address."""

    def run(*words):
        program = start(lcmtools_path, "foxglove", "--port", "0", *words, LCM_DEFAULT_URL=bus_url)
        said = program.wait_for("in Foxglove")
        return program, said.partition(" connection to ")[2].split()[0]

    return run


@contextmanager
def _client(url, origin=None):
    protocols = ["foxglove.sdk.v1"]
    with connect(url, origin=origin, subprotocols=protocols) as connection:
        yield Client(connection)


def _of_ros(payload, cls):
    return Schemas().read(cls, "ros1", payload)


def test_a_latched_message_comes_to_each_client(serve, start_node, wait_until):
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


def test_the_graph_is_drawn_and_excluded_topics_are_not_offered(serve, start_node):
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


def test_a_client_publishes_only_where_it_may(serve, start_node, wait_until):
    got = []
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


def test_nobody_publishes_by_default(serve):
    _, url = serve()
    with _client(url) as client:
        assert "clientPublish" not in client.wait(lambda one: "capabilities" in one)["capabilities"]
        client.publish("/cmd", {"linear": {"x": 1}})
        said = client.wait(lambda one: one.get("op") == "status")["message"]
        assert "publish" in said.lower()


def test_a_foreign_page_is_refused_until_it_is_allowed(serve):
    origins = "https://evil.example", "null", "file://", "http://127.0.0.1:8765", "http://localhost"
    program, url = serve("--allow-origin", "https://app.foxglove.dev")
    for origin in origins:
        for _ in range(2):
            with pytest.raises(InvalidStatus) as caught, _client(url, origin):
                pass
            assert caught.value.response.status_code == 403
        program.wait_for(f"a page of {origin} was refused; --allow-origin {origin} lets it in")
    assert len(program.lines) == 1 + len(origins), program.output  # each is said once
    allowed = (f"{one}/" if "." in one else one for one in origins)
    _, other = serve(*(word for one in allowed for word in ("--allow-origin", one)))
    for origin in origins:
        with _client(other, origin) as client:
            assert client.wait(lambda one: one.get("op") == "serverInfo")


def test_the_origins_of_a_page_and_of_no_page_are_let_in(serve):
    _, url = serve(
        "--allow-origin", "https://APP.foxglove.dev/", "--allow-origin", "http://[::1]:8080"
    )
    for origin in ("https://app.foxglove.dev", "http://[::1]:8080", None):
        with _client(url, origin) as client:
            assert client.wait(lambda one: one.get("op") == "serverInfo")
    with pytest.raises(InvalidStatus), _client(url, "https://app.foxglove.dev.evil.example"):
        pass


def test_an_origin_in_another_form_is_refused_too(serve):
    program, url = serve("--allow-origin", "https://app.foxglove.dev")
    for origin in (
        b"oRiGiN :https://evil.example",
        b"Origin: https://app.foxglove.dev\r\nOrigin: https://e.com",
        b"Origin: \x1b[2J$(reboot)",
    ):
        with socket.create_connection(("127.0.0.1", int(url.rpartition(":")[2]))) as raw:
            raw.sendall(b"GET / HTTP/1.1\r\n" + origin + b"\r\n\r\n")
            assert raw.recv(100).startswith(b"HTTP/1.1 403 "), origin
    assert "reboot" not in program.output


@pytest.mark.skipif(sys.platform != "linux", reason="/proc lists the sockets of a process")
def test_no_page_can_guess_the_address_behind_the_gate(serve):
    program, url = serve()
    folder = Path(f"/proc/{program.pid}")
    inodes = {str(one.readlink())[8:-1] for one in (folder / "fd").iterdir()}
    rows = [line.split() for line in (folder / "net/tcp").read_text().splitlines()[1:]]
    ours = [row[1] for row in rows if row[3] == "0A" and row[9] in inodes]
    hosts = {socket.inet_ntoa(struct.pack("=I", int(one.partition(":")[0], 16))) for one in ours}
    assert len(ours) == len(hosts) == 2
    [hidden] = hosts - {"127.0.0.1"}
    assert hidden.startswith("127.")
    assert hidden != "127.0.0.1"
    assert url.startswith("ws://127.0.0.1:")


def test_connections_end_with_the_command(serve):
    program, url = serve()
    with _client(url) as client:
        client.wait(lambda one: one.get("op") == "serverInfo")
        program.send_signal(signal.SIGINT)
        with pytest.raises(ConnectionClosed):
            client.wait(lambda _: False)
    assert program.wait() == 128 + signal.SIGINT


def test_a_script_reads_the_address(start, bus_url, lcmtools_path):
    words = ("foxglove", "--port", "0", "--json")
    program = start(lcmtools_path, *words, LCM_DEFAULT_URL=bus_url)
    program.wait_for("}")
    with _client(json.loads("".join(program.lines))["address"]) as client:
        assert client.wait(lambda one: one.get("op") == "serverInfo")


def test_a_port_that_is_taken_is_an_error(serve, cli, bus_url):
    _, url = serve()
    port = url.rpartition(":")[2]
    result = cli("foxglove", "--port", port, env={"LCM_DEFAULT_URL": bus_url})
    said = f"lcmtools foxglove: cannot listen at 127.0.0.1:{port}: Address already in use"
    assert (result.code, result.err) == (1, f"{said}; --port N chooses another port\n")


@pytest.mark.parametrize("missing", ["foxglove", "rosbags.typesys"])
def test_a_missing_extra_is_named(cli, bus_url, monkeypatch, missing):
    monkeypatch.setitem(sys.modules, missing, None)
    result = cli("foxglove", env={"LCM_DEFAULT_URL": bus_url})
    assert (result.code, result.err.count("\n")) == (3, 1)
    install = "pip install 'lcmtools-robotics[foxglove]'\n"
    assert_line(result.err, "lcmtools foxglove: ", "extra 'foxglove' (", install)
