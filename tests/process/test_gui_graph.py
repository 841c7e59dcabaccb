"""The window's graph over a real bus, without a browser: its places, rates and findings."""

import pytest
from fixtures.window import LiveWindow

from lcmtools import Node
from lcmtools.types.std_msgs import String


@pytest.mark.usefixtures("quiet_network")
def test_the_graph_has_rates_and_the_findings_their_nodes(start_node, bus_url):
    talker = start_node(lambda: Node("talker")).node
    publisher = talker.create_publisher(String, "/chatter")
    talker.create_timer(0.05, lambda: publisher.publish(String()))
    listener = start_node(lambda: Node("listener")).node
    listener.create_subscription(String, "/chatte", lambda _: None)
    window = LiveWindow(bus_url)
    try:
        with window.page() as page:
            page.open(1, "graph")
            found = page.data(1, lambda data: any(edge["rate"] for edge in data["edges"]))
            assert {"node:/talker", "topic:/chatter"} <= {one["key"] for one in found["vertices"]}
            page.open(2, "findings")
            faults = page.data(2, lambda data: data["findings"])["findings"]
            fault = next(one for one in faults if one["rule"] == "unconnected-subscriptions")
            assert fault["severity"] == "warning"
            assert {"/listener", "/chatte"} <= {one["name"] for one in fault["subjects"]}
            assert any("/chatter" in remedy for remedy in fault["remedies"])
    finally:
        window.end()
