"""The window's graph over a real bus, without a browser: its places, rates and findings."""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from websockets.sync.client import ClientConnection, connect

from lcmtools import Node
from lcmtools.types.std_msgs import String

pytestmark = pytest.mark.usefixtures("quiet_network")


@contextmanager
def _page(url: str) -> Iterator[ClientConnection]:
    address = url.replace("http", "ws").rstrip("/") + "/socket"
    with connect(address, subprotocols=["lcmtools.1"], origin=url.rstrip("/")) as page:  # type: ignore[list-item, arg-type]
        yield page


def _wait(page: ClientConnection, number: int, fits: Callable[[Any], object]) -> Any:
    """Return the first data of a stream that fit."""
    while True:
        frame = json.loads(page.recv(timeout=40))
        if frame.get("id") == number and "data" in frame and fits(frame["data"]):
            return frame["data"]


def test_the_graph_has_rates_and_the_findings_their_nodes(
    start: Callable[..., Any], start_node: Callable[..., Any], bus_url: str, lcmtools_path: str
) -> None:
    talker = start_node(lambda: Node("talker")).node
    publisher = talker.create_publisher(String, "/chatter")
    talker.create_timer(0.05, lambda: publisher.publish(String()))
    listener = start_node(lambda: Node("listener")).node
    listener.create_subscription(String, "/chatte", lambda _: None)
    program = start(
        lcmtools_path, "gui", "graph", "--port", "0", "--no-open", LCM_DEFAULT_URL=bus_url
    )
    url = program.wait_for("to command: ").partition(": ")[2]
    with _page(url) as page:
        page.send(json.dumps({"op": "open", "id": 1, "stream": "graph"}))
        found = _wait(page, 1, lambda data: any(edge["rate"] for edge in data["edges"]))
        assert {"node:/talker", "topic:/chatter"} <= {one["key"] for one in found["vertices"]}
        page.send(json.dumps({"op": "open", "id": 2, "stream": "findings"}))
        [fault] = _wait(page, 2, lambda data: data["findings"])["findings"]
        assert (fault["rule"], fault["severity"]) == ("unconnected-subscriptions", "warning")
        assert {"/listener", "/chatte"} <= {one["name"] for one in fault["subjects"]}
        assert any("/chatter" in remedy for remedy in fault["remedies"])
