"""Words for what is known of topics, types and senders; shared by the commands that show them."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from lcmtools.graph.model import Node, Topic, Traffic
from lcmtools.messages.registry import candidates

if TYPE_CHECKING:  # most commands do without
    from lcmtools.bus.processes import Process

UNKNOWN = "unknown type"


def type_text(topic: Topic) -> str:
    """A topic's type: as announced, else by the fingerprints seen, else "unknown type".

    Several differing types are all named: that is a fault, and lcmtools wtf explains it.
    """
    return ", ".join(topic.types or seen_types(topic)) or UNKNOWN


def seen_types(topic: Topic) -> list[str]:
    """The types that the fingerprints seen on the channel may mean, the likeliest of each."""
    return list(
        dict.fromkeys(names[0] for value in topic.fingerprints if (names := candidates(value)))
    )


def fingerprint_text(fingerprint: int) -> str:
    """A fingerprint with what it may be: "0x2e7c… (geometry_msgs/Twist or geometry_msgs/Accel)"."""
    names = candidates(fingerprint)
    return f"{fingerprint:#018x} ({' or '.join(names) if names else UNKNOWN})"


def fingerprint_rows(topic: Topic) -> list[str]:
    """The fingerprints seen on a topic, a line each; one line where they only keep changing."""
    if len(topic.fingerprints) > 1 and not seen_types(topic):
        return ["Fingerprint: changes from message to message, as in data that is no LCM message"]
    return [f"Fingerprint: {fingerprint_text(value)}" for value in topic.fingerprints]


def node_record(node: Node) -> dict[str, object]:
    """A node and where it runs, for JSON."""
    return {
        "node": node.name,
        "host": node.host,
        "address": node.sender.address if node.sender else None,
        "pid": node.pid,
        "command": node.command,
        "start_time": node.start_time,
        "stale": node.stale.value or None,
    }


def node_text(node: Node) -> str:
    """A node with where it runs."""
    stale = f", stale: {node.stale}" if node.stale else ""
    return f"{node.name} ({host_text(node)}, pid {node.pid}{stale})"


def host_text(node: Node) -> str:
    """The computer that a node runs on; of another one also the address: "ada at 10.0.0.1"."""
    from lcmtools.observe.computers import address_of

    address = address_of(node)
    return f"{node.host} at {address}" if address else node.host


def listed_node(node: Node) -> str:
    """A node as lists show it: its name, and what is the matter with it."""
    return f"{node.name} (stale: {node.stale})" if node.stale else node.name


def program_text(traffic: Traffic) -> str:
    """Return the program behind a sender that is no node, as far as the system tells."""
    from lcmtools.bus.processes import is_local
    from lcmtools.observe.senders import SocketTable

    sender = traffic.sender
    if sender is None:
        return "a program that is no node (this kind of bus does not tell senders)"
    if not is_local(sender.address):
        return f"a program on {sender.address}, port {sender.port}"
    found = SocketTable.read({sender.port}).processes(sender)
    if found.only:
        return f"{found.only.command} (pid {found.only.pid}, port {sender.port})"
    return f"a program of this computer, port {sender.port}{candidates_text(found.candidates)}"


def candidates_text(processes: "Sequence[Process]") -> str:
    """Return the processes that a program may be, to stand behind it; "" for none."""
    names = [f"{process.command} (pid {process.pid})" for process in processes]
    return f": maybe {' or '.join(names)}" if names else ""
