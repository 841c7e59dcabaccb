"""The names of a bus's computers, and the part of its topics that is on each.

A computer goes by the name that its nodes announce. Where that is not known, or two computers have
the same one, its address tells it.
"""

import socket
from collections.abc import Iterable
from dataclasses import replace

from lcmtools.bus.processes import is_local
from lcmtools.graph.model import Node, Topic, Traffic


class Computers:
    """The computers that nodes run on.

    Args:
        nodes: All that are known.
    """

    def __init__(self, nodes: Iterable[Node]) -> None:
        self._own = socket.gethostname()
        self._names: dict[str, str] = {}  # of other computers, by address
        self._twice = {self._own}  # names that more than one computer has, or may have
        for node in nodes:
            self._learn(node)

    def of(self, node: Node) -> str:
        """The computer that a node is on."""
        address = address_of(node)
        if address and node.host in self._twice:
            return f"{node.host} ({address})"
        return node.host

    def of_traffic(self, traffic: Traffic) -> str:
        """The computer that a sender is on."""
        if traffic.sender is None:
            return "unknown"
        address = traffic.sender.address
        if is_local(address):
            return self._own
        name = self._names.get(address, address)
        return f"{name} ({address})" if name in self._twice else name

    def _learn(self, node: Node) -> None:
        address = address_of(node)
        if address and self._names.setdefault(address, node.host) == node.host:
            others = {at for at, name in self._names.items() if name == node.host}
            if len(others) > 1:
                self._twice.add(node.host)


def address_of(node: Node) -> str:
    """The address of another computer that a node is on; "" for this one, or where none shows."""
    if node.sender is None or is_local(node.sender.address):
        return ""
    return node.sender.address


def by_computer(topics: Iterable[Topic]) -> dict[str, list[Topic]]:
    """The part of each topic that is on each computer, by the computer's name, sorted."""
    topics = list(topics)
    computers = Computers(node for topic in topics for node in _nodes(topic))
    found: dict[str, list[Topic]] = {}
    for topic in topics:
        names = [computers.of(node) for node in _nodes(topic)]
        for name in dict.fromkeys([*names, *map(computers.of_traffic, topic.foreign)]):
            found.setdefault(name, []).append(_part(topic, name, computers))
    return dict(sorted(found.items()))


def _nodes(topic: Topic) -> list[Node]:
    return [node for node, _ in topic.publishers + topic.subscribers]


def _part(topic: Topic, name: str, computers: Computers) -> Topic:
    """The part of a topic that is on one computer."""
    foreign = tuple(seen for seen in topic.foreign if computers.of_traffic(seen) == name)
    publishers = tuple(pair for pair in topic.publishers if computers.of(pair[0]) == name)
    return replace(
        topic,
        publishers=publishers,
        subscribers=tuple(pair for pair in topic.subscribers if computers.of(pair[0]) == name),
        traffic=topic.traffic if publishers else foreign,
        foreign=foreign,
    )
