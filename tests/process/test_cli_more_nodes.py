"""node machine, on a bus with two nodes of this computer and one that says it is elsewhere."""

import json
import socket

import pytest
from fixtures.says import assert_line

HOST = socket.gethostname()

# A node of another computer, as its announcements are heard here.
_ELSEWHERE = """
import time
import lcm
from lcmtools.graph.model import NodeInfo
from lcmtools.graph.protocol import NODE_CHANNEL, Announcement, encode_announcement

bus = lcm.LCM()
node = NodeInfo("/far/away", "id-1", "far-computer", 7, start_time=time.time_ns())
while True:
    bus.publish(NODE_CHANNEL, encode_announcement(Announcement(node, False, 0)))
    print("announced", flush=True)
    time.sleep(0.02)
"""


@pytest.fixture
def nodes(bus_url, start, start_python, lcmtools_path, monkeypatch):
    """A talker, a listener and the far node."""
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    start_python(_ELSEWHERE).wait_for("announced")
    listener = start(lcmtools_path, "run", "listener")
    start(lcmtools_path, "run", "talker")
    listener.wait_for("I heard: [hello world")


@pytest.mark.usefixtures("nodes")
def test_node_machine_lists_the_computers_and_the_nodes_of_one(cli):
    result = cli("node", "machine")
    hosts = sorted(["far-computer", HOST])
    assert (result.code, result.out.splitlines(), result.err) == (0, hosts, "")

    assert cli("node", "machine", HOST).out == "/listener\n/talker\n"
    assert cli("node", "machine", "far-computer").out == "/far/away\n"
    documents = json.loads(cli("node", "machine", "--json").out)
    assert {"host": HOST, "nodes": ["/listener", "/talker"]} in documents
    assert {"host": "far-computer", "nodes": ["/far/away"]} in documents
    assert json.loads(cli("node", "machine", "far-computer", "--json").out) == [
        {"host": "far-computer", "nodes": ["/far/away"]}
    ]

    unknown = cli("node", "machine", "far-compter")
    assert (unknown.code, unknown.out) == (1, "")
    parts = ("far-compter; did you mean far-computer?\n",)
    assert_line(unknown.err, "lcmtools node machine: no node", *parts)


def test_node_machine_where_no_node_is_says_so_on_standard_error(cli, bus_url):
    result = cli("node", "machine", "--lcm-url", bus_url)
    assert (result.code, result.out) == (0, "")
    assert result.err == f"no nodes on {bus_url}\n"
