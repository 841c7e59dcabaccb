"""list, node list and info show everything at once, however many nodes there are."""

import json
import os

import pytest

from lcmtools import Node
from lcmtools.types.std_msgs import String

NODES = 20

pytestmark = pytest.mark.usefixtures("use_module_bus", "nodes")


@pytest.fixture(scope="module")
def nodes(module_start_node):
    """Twenty nodes."""

    def make(number):
        def node():
            one = Node(f"node{number:02}", namespace=f"/robot{number % 4}")
            one.create_publisher(String, f"out{number:02}")
            one.create_subscription(String, f"in{number:02}", lambda _: None)
            one.create_subscription(String, "/everybody", lambda _: None)
            return one

        return node

    for number in range(NODES):
        module_start_node(make(number))


def names(kind):
    return [f"/robot{i % 4}/{kind}{i:02}" for i in range(NODES)]


def test_list_has_every_topic_at_once(cli):
    topics = [*names("out"), *names("in"), "/everybody", "/rosout"]
    assert cli("list").out.splitlines() == sorted(topics)


def test_node_list_has_every_node_at_once(cli):
    assert cli("node", "list").out.splitlines() == sorted(names("node"))


@pytest.mark.parametrize("namespace", ["robot1", "/robot1"])
def test_lists_keep_to_a_namespace(namespace, cli):
    in_robot1 = [name for name in names("node") if name.startswith("/robot1/")]
    assert cli("node", "list", namespace).out.splitlines() == in_robot1
    topics = [name for name in names("in") + names("out") if name.startswith("/robot1/")]
    assert cli("list", namespace).out.splitlines() == sorted(topics)


def test_info_has_every_subscriber_at_once(cli):
    (topic,) = json.loads(cli("info", "--json", "/everybody").out)
    assert [endpoint["node"] for endpoint in topic["subscribers"]] == sorted(names("node"))


def test_node_json_names_the_process(cli):
    nodes = json.loads(cli("node", "list", "--json").out)
    assert {node["pid"] for node in nodes} == {os.getpid()}
    assert all(node["stale"] is None for node in nodes)


def test_short_name_of_one_node_is_enough(cli):
    assert "Node [/robot3/node07]\n" in cli("node", "info", "node07").out
