"""Names of the computers of a bus."""

import pytest

from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role, Traffic
from lcmtools.observe.reports import describe
from lcmtools.observe.reports.describe import Computers, by_computer
from lcmtools.wire.packet import Sender


@pytest.fixture(autouse=True)
def _here(monkeypatch):
    """This computer is "here", and 10.0.0.9 is its address."""
    monkeypatch.setattr(describe.socket, "gethostname", lambda: "here")
    monkeypatch.setattr(describe, "is_local", lambda address: address == "10.0.0.9")


def _node(host, address, topic="/a"):
    sender = Sender(address, 40_000) if address else None
    endpoints = (Endpoint(topic, Role.PUBLISHER),)
    return NodeInfo(f"/{host}", f"{host}{address}", host, 1, endpoints=endpoints, sender=sender)


def _seen(channel, address):
    sender = Sender(address, 50_000) if address else None
    return Traffic(channel, sender, (), 1, 1, 1, 1)


def test_a_computer_goes_by_its_name():
    node = _node("ada", "10.0.0.1")
    assert Computers([node]).of(node) == "ada"


def test_computers_of_one_name_go_by_their_addresses_too():
    one, other = _node("robot", "10.0.0.1"), _node("robot", "10.0.0.2")
    names = Computers([one, other])
    assert [names.of(one), names.of(other)] == ["robot (10.0.0.1)", "robot (10.0.0.2)"]


def test_another_computer_with_the_name_of_this_one_is_not_this_one():
    own, other = _node("here", "10.0.0.9"), _node("here", "10.0.0.1")
    names = Computers([other])
    assert [names.of(own), names.of(other)] == ["here", "here (10.0.0.1)"]


def test_a_node_of_which_no_address_is_known_goes_by_its_name():
    node = _node("ada", None)
    assert Computers([node]).of(node) == "ada"


@pytest.mark.parametrize(
    ("address", "name"),
    [("10.0.0.1", "ada"), ("10.0.0.2", "10.0.0.2"), ("10.0.0.9", "here"), (None, "unknown")],
)
def test_a_program_is_on_the_computer_of_its_address(address, name):
    assert Computers([_node("ada", "10.0.0.1")]).of_traffic(_seen("A", address)) == name


def test_topics_are_divided_by_computer():
    nodes = (_node("ada", "10.0.0.1"), _node("here", "10.0.0.9"))
    graph = Graph(nodes, (_seen("B", "10.0.0.2"), _seen("/a", "10.0.0.2")))
    found = by_computer([graph.topic("/a"), graph.topic("B")])
    names = {host: [topic.name for topic in topics] for host, topics in found.items()}
    assert names == {"10.0.0.2": ["/a", "B"], "ada": ["/a"], "here": ["/a"]}
    (part,) = found["ada"]
    assert [node.host for node, _ in part.publishers] == ["ada"]
    assert part.foreign == ()
