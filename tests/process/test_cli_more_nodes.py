"""node machine, on a bus with two nodes of this computer and one that says it is elsewhere."""

import json
import socket
import subprocess
from collections.abc import Callable
from typing import Any

import pytest

Run = Callable[..., subprocess.CompletedProcess[str]]

HOST = socket.gethostname()

# A node of another computer, as its announcements are heard here.
_ELSEWHERE = """
import time
import lcm
from lcmtools.graph.model import Node
from lcmtools.graph.protocol import NODE_CHANNEL, Announcement, encode_announcement

bus = lcm.LCM()
node = Node("/far/away", "id-1", "far-computer", 7, start_time=time.time_ns())
while True:
    bus.publish(NODE_CHANNEL, encode_announcement(Announcement(node, False, 0)))
    print("announced", flush=True)
    time.sleep(0.02)
"""


@pytest.fixture
def nodes(
    bus_url: str,
    start: Callable[..., Any],
    start_python: Callable[..., Any],
    lcmtools_path: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A talker, a listener and the far node."""
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    start_python(_ELSEWHERE).wait_for("announced")
    listener = start(lcmtools_path, "run", "listener")
    start(lcmtools_path, "run", "talker")
    listener.wait_for("I heard: [hello world")


@pytest.mark.usefixtures("nodes")
def test_node_machine_lists_the_computers_and_the_nodes_of_one(lcmtools: Run) -> None:
    result = lcmtools("node", "machine")
    hosts = sorted(["far-computer", HOST])
    assert (result.returncode, result.stdout.splitlines(), result.stderr) == (0, hosts, "")

    assert lcmtools("node", "machine", HOST).stdout == "/listener\n/talker\n"
    assert lcmtools("node", "machine", "far-computer").stdout == "/far/away\n"
    documents = json.loads(lcmtools("node", "machine", "--json").stdout)
    assert {"host": HOST, "nodes": ["/listener", "/talker"]} in documents
    assert {"host": "far-computer", "nodes": ["/far/away"]} in documents
    assert json.loads(lcmtools("node", "machine", "far-computer", "--json").stdout) == [
        {"host": "far-computer", "nodes": ["/far/away"]}
    ]

    unknown = lcmtools("node", "machine", "far-compter")
    assert (unknown.returncode, unknown.stdout) == (1, "")
    assert unknown.stderr == (
        "lcmtools node machine: no node runs on machine far-compter; did you mean far-computer?\n"
    )


def test_node_machine_where_no_node_is_says_so_on_standard_error(
    lcmtools: Run, bus_url: str
) -> None:
    result = lcmtools("node", "machine", "--lcm-url", bus_url)
    assert (result.returncode, result.stdout) == (0, "")
    assert result.stderr == f"no nodes on {bus_url}\n"
