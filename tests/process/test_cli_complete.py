"""list, node list and info show everything at once, however many nodes there are."""

import json
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import pytest

Run = Callable[..., subprocess.CompletedProcess[str]]

NODES = 20

_MANY_NODES = f"""
import lcmtools
from lcmtools.types.std_msgs import String

lcmtools.init()
nodes = [lcmtools.Node(f"node{{i:02}}", namespace=f"/robot{{i % 4}}") for i in range({NODES})]
for i, node in enumerate(nodes):
    node.create_publisher(String, f"out{{i:02}}")
    node.create_subscription(String, f"in{{i:02}}", print)
    node.create_subscription(String, "/everybody", print)
print("ready", flush=True)
lcmtools.spin(*nodes)
"""

pytestmark = pytest.mark.usefixtures("use_module_bus", "nodes")


@pytest.fixture(scope="module")
def nodes(module_start: Callable[..., Any], tmp_path_factory: pytest.TempPathFactory) -> None:
    """Twenty nodes of one process."""
    script = tmp_path_factory.mktemp("many") / "many.py"
    script.write_text(_MANY_NODES)
    module_start(sys.executable, str(script)).wait_for("ready")


def names(kind: str) -> list[str]:
    return [f"/robot{i % 4}/{kind}{i:02}" for i in range(NODES)]


@pytest.mark.parametrize("_time", range(3))
def test_list_has_every_topic_at_once(_time: int, lcmtools: Run) -> None:
    topics = [*names("out"), *names("in"), "/everybody", "/rosout"]
    assert lcmtools("list").stdout.splitlines() == sorted(topics)


@pytest.mark.parametrize("_time", range(3))
def test_node_list_has_every_node_at_once(_time: int, lcmtools: Run) -> None:
    assert lcmtools("node", "list").stdout.splitlines() == sorted(names("node"))


def test_node_list_keeps_to_a_namespace(lcmtools: Run) -> None:
    in_robot1 = [name for name in names("node") if name.startswith("/robot1/")]
    assert lcmtools("node", "list", "robot1").stdout.splitlines() == in_robot1
    assert lcmtools("node", "list", "/robot1").stdout.splitlines() == in_robot1


def test_list_keeps_to_a_namespace(lcmtools: Run) -> None:
    topics = [name for name in names("in") + names("out") if name.startswith("/robot2/")]
    assert lcmtools("list", "/robot2").stdout.splitlines() == sorted(topics)


def test_info_has_every_subscriber_at_once(lcmtools: Run) -> None:
    (topic,) = json.loads(lcmtools("info", "--json", "/everybody").stdout)
    assert [endpoint["node"] for endpoint in topic["subscribers"]] == sorted(names("node"))


def test_node_json_names_the_process(lcmtools: Run) -> None:
    nodes = json.loads(lcmtools("node", "list", "--json").stdout)
    assert len({node["pid"] for node in nodes}) == 1
    assert all("many.py" in node["command"] for node in nodes)
    assert all(node["stale"] is None for node in nodes)


def test_short_name_of_one_node_is_enough(lcmtools: Run) -> None:
    assert "Node [/robot3/node07]\n" in lcmtools("node", "info", "node07").stdout
