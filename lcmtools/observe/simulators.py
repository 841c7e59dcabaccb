"""Simulators, and publishers of simulated time.

Most are both. But a log that is played with its clock publishes the time and simulates nothing, and
a simulator that follows the time of another one publishes none.
"""

from lcmtools.clock import CLOCK_TOPIC
from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role

_SERVICES = "sim_msgs/"  # types of services that only simulators offer
_PAUSED = 1_000_000_000  # [ns] without a message of a clock, which sends ten a second at least


def is_simulator(node: NodeInfo) -> bool:
    """Return whether a node is a simulator, by the services that it offers.

    It obeys what it subscribes to, its topics have fixed names and types, and it measures only for
    subscribers.
    """
    ends = (end for end in node.endpoints if end.role is Role.SERVICE)
    return any(name.startswith(_SERVICES) for end in ends for name in end.types)


def simulators(graph: Graph) -> list[NodeInfo]:
    """Return the living simulators."""
    return [node for node in graph.nodes if not node.stale and is_simulator(node)]


def publishes_time(node: NodeInfo) -> bool:
    """Return whether a node publishes the simulated time."""
    return any(e.topic == CLOCK_TOPIC for e in _published(node))


def _published(node: NodeInfo) -> list[Endpoint]:
    return [end for end in node.endpoints if end.role is Role.PUBLISHER]


def silence(node: NodeInfo, endpoint: Endpoint, now: int) -> int:
    """Return the time from an endpoint's last message to its node's last announcement [ns].

    Before the first message, it is the time since the node's start. ``now`` is the time here
    [ns since 1970].
    """
    return (node.sent or node.time_there(now)) - (endpoint.last_time or node.start_time)


def is_paused(node: NodeInfo, now: int) -> bool:
    """Return whether a node publishes the simulated time, and none for a second, by its counter."""
    return any(e.topic == CLOCK_TOPIC and silence(node, e, now) > _PAUSED for e in _published(node))


def pause_text(graph: Graph) -> str:
    """Return "the simulator /sim is paused: ..." as the reason why messages are missing.

    "" if the simulated time passes, or there is none.
    """
    for node in graph.nodes:
        if not node.stale and is_paused(node, graph.time):
            if is_simulator(node):
                return f"the simulator {node.name} is paused: lcmtools sim resume"
            return f"the simulated time, published by {node.name}, stands still"
    return ""


def has_simulated_time(graph: Graph) -> bool:
    """Return whether anything on the bus, or in the log, publishes the simulated time."""
    is_announced = any(publishes_time(node) for node in graph.nodes if not node.stale)
    return is_announced or bool(graph.topic(CLOCK_TOPIC).traffic)
