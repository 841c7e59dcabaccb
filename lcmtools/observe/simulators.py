"""Simulators, and publishers of simulated time.

Most are both. But a log that is played with its clock publishes the time and simulates nothing, and
a simulator that follows the time of another one publishes none.
"""

from lcmtools.clock import CLOCK_TOPIC
from lcmtools.graph.model import Graph, Node, Role

_SERVICES = "sim_msgs/"  # types of services that only simulators offer


def is_simulator(node: Node) -> bool:
    """Return whether a node is a simulator, by the services that it offers.

    It obeys what it subscribes to, its topics have fixed names and types, and it measures only for
    subscribers.
    """
    ends = (end for end in node.endpoints if end.role is Role.SERVICE)
    return any(name.startswith(_SERVICES) for end in ends for name in end.types)


def simulators(graph: Graph) -> list[Node]:
    """Return the living simulators."""
    return [node for node in graph.nodes if not node.stale and is_simulator(node)]


def publishes_time(node: Node) -> bool:
    """Return whether a node publishes the simulated time."""
    return any(e.topic == CLOCK_TOPIC and e.role is Role.PUBLISHER for e in node.endpoints)


def has_simulated_time(graph: Graph) -> bool:
    """Return whether anything on the bus, or in the log, publishes the simulated time."""
    is_announced = any(publishes_time(node) for node in graph.nodes if not node.stale)
    return is_announced or bool(graph.topic(CLOCK_TOPIC).traffic)
