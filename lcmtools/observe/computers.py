"""The names of a bus's computers, and the part of its topics that is on each.

A computer is named as its nodes announce it. Where that is not known, or two computers have the
same name, its address is shown.
"""

import socket
from collections.abc import Iterable
from dataclasses import replace

from lcmtools.bus.processes import is_local
from lcmtools.graph.model import Endpoint, Node, Topic, Traffic


class Computers:
    """The computers that ``nodes`` run on; pass all nodes that are known."""

    def __init__(self, nodes: Iterable[Node]) -> None:
        self._own = socket.gethostname()
        self._names: dict[str, str] = {}  # of other computers, by address
        for node in nodes:
            if address := address_of(node):
                self._names.setdefault(address, node.host)
        names = [self._own, *self._names.values()]
        self._twice = {self._own, *(name for name in names if names.count(name) > 1)}

    def of(self, node: Node) -> str:
        """Return the name of the computer that a node is on."""
        address = address_of(node)
        return f"{node.host} ({address})" if address and node.host in self._twice else node.host

    def of_traffic(self, traffic: Traffic) -> str:
        """Return the name of the computer that a sender is on."""
        if traffic.sender is None:
            return "unknown"
        address = traffic.sender.address
        if is_local(address):
            return self._own
        name = self._names.get(address, address)
        return f"{name} ({address})" if name in self._twice else name


def address_of(node: Node) -> str:
    """Return the address of a node's computer; "" for this computer, or if unknown."""
    return "" if node.sender is None or is_local(node.sender.address) else node.sender.address


def by_computer(topics: Iterable[Topic]) -> dict[str, list[Topic]]:
    """Return the part of each topic that is on each computer, by the computer's name, sorted."""
    topics = list(topics)
    nodes = {topic: [node for node, _ in topic.publishers + topic.subscribers] for topic in topics}
    computers = Computers(node for found in nodes.values() for node in found)
    parts: dict[str, list[Topic]] = {}
    for topic in topics:
        names = [*map(computers.of, nodes[topic]), *map(computers.of_traffic, topic.foreign)]
        for name in dict.fromkeys(names):
            parts.setdefault(name, []).append(_part(topic, name, computers))
    return dict(sorted(parts.items()))


def _part(topic: Topic, name: str, computers: Computers) -> Topic:
    def there(ends: tuple[tuple[Node, Endpoint], ...]) -> tuple[tuple[Node, Endpoint], ...]:
        return tuple(end for end in ends if computers.of(end[0]) == name)

    foreign = tuple(seen for seen in topic.foreign if computers.of_traffic(seen) == name)
    publishers = there(topic.publishers)
    return replace(
        topic,
        publishers=publishers,
        subscribers=there(topic.subscribers),
        traffic=topic.traffic if publishers else foreign,
        foreign=foreign,
    )
