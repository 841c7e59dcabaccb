"""Words for topics, types, nodes and senders, shared by the commands that show them."""

from collections.abc import Iterable, Sequence

from lcmtools.bus.processes import Process, is_local
from lcmtools.graph.model import Node, Topic, Traffic
from lcmtools.messages.registry import candidates
from lcmtools.observe.computers import address_of
from lcmtools.observe.senders import SocketTable

UNKNOWN = "unknown type"


def type_text(topic: Topic) -> str:
    """Return a topic's type: as announced, else by the fingerprints seen, else "unknown type".

    Several differing types are all named: that is a fault, and lcmtools wtf explains it.
    """
    return ", ".join(topic.types or seen_types(topic.fingerprints)) or UNKNOWN


def seen_types(fingerprints: Iterable[int]) -> tuple[str, ...]:
    """Return the likeliest type of each fingerprint."""
    return tuple(dict.fromkeys(name for value in fingerprints for name in candidates(value)[:1]))


def fingerprint_rows(topic: Topic) -> list[str]:
    """Return the fingerprints seen on a topic, a line each; one line if they keep changing."""
    if len(topic.fingerprints) > 1 and not seen_types(topic.fingerprints):
        return ["Fingerprint: changes from message to message, as in data that is no LCM message"]
    return [
        f"Fingerprint: {value:#018x} ({' or '.join(candidates(value)) or UNKNOWN})"
        for value in topic.fingerprints
    ]


def node_record(node: Node) -> dict[str, object]:
    """Return a node and its place, for JSON."""
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
    """Return a node with its place."""
    stale = f", stale: {node.stale}" if node.stale else ""
    return f"{node.name} ({host_text(node)}, pid {node.pid}{stale})"


def host_text(node: Node) -> str:
    """Return a node's computer, of another one with the address: "ada at 10.0.0.1"."""
    address = address_of(node)
    return f"{node.host} at {address}" if address else node.host


def listed_node(node: Node) -> str:
    """Return a node's name, and the reason why it is stale."""
    return f"{node.name} (stale: {node.stale})" if node.stale else node.name


def program_text(traffic: Traffic) -> str:
    """Return the program behind a sender that is no node, as far as the system tells."""
    sender = traffic.sender
    if sender is None:
        return "a plain LCM program (this kind of bus does not identify senders)"
    if not is_local(sender.address):
        return f"a program on {sender.address}, port {sender.port}"
    found = SocketTable.read({sender.port}).processes(sender)
    if found.only:
        return f"{found.only.command} (pid {found.only.pid}, port {sender.port})"
    return f"a program of this computer, port {sender.port}{candidates_text(found.candidates)}"


def candidates_text(processes: Sequence[Process]) -> str:
    """Return ": maybe …" with the processes that a program may be; "" for none."""
    names = [f"{process.command} (pid {process.pid})" for process in processes]
    return f": maybe {' or '.join(names)}" if names else ""
