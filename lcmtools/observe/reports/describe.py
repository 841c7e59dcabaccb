"""Texts for topics, types, nodes, senders and computers, shared by commands that show them."""

import socket
from collections.abc import Iterable, Sequence
from itertools import chain

from lcmtools.bus.processes import Process, is_local
from lcmtools.bus.sockets import SocketTable
from lcmtools.errors import LcmtoolsError
from lcmtools.graph.command_line import LONGEST_COMMAND, shortened
from lcmtools.graph.model import Endpoint, Ends, Graph, NodeInfo, Topic, Traffic
from lcmtools.names import did_you_mean, is_of_lcm
from lcmtools.observe.reading.decoding import like_text, possible_types
from lcmtools.observe.reading.senders import is_contained

UNKNOWN = "unknown type"
NO_TYPE = "no type: LCM's own channel"

Kinds = tuple[tuple[str, ...], ...]
"""Types of a topic: of each the names that it may have, the likeliest first; one if certain."""


def size_text(value: float | None) -> str:
    """A number of bytes as text, a KB being 1000: "812 B", "36.2 KB"; "-" for an unknown number."""
    if value is None:
        return "-"
    units = ["B", "KB", "MB", "GB"]
    while value >= 999.5 and len(units) > 1:  # noqa: PLR2004 - would round to four digits
        value, units = value / 1000, units[1:]
    digits = 0 if units[0] == "B" or value >= 99.95 else 1 if value >= 9.995 else 2  # noqa: PLR2004
    return f"{value:.{digits}f} {units[0]}"


def type_text(topic: Topic) -> str:
    """Return a topic's types as one line; "unknown type" if none is known.

    If types differ, all are named: that is a fault, which lcmtools wtf explains.
    """
    return kinds_text(topic_kinds(topic), topic.name)


def kinds_text(kinds: Kinds, channel: str = "") -> str:
    """Return types as one line: "arm/point_t (one of 3)" if others have the same fields."""
    unknown = NO_TYPE if is_of_lcm(channel) else UNKNOWN
    return ", ".join(map(one_of, kinds)) or unknown


def one_of(names: Sequence[str]) -> str:
    """Return the first of the names that a type may have, marked if there are several."""
    return f"{names[0]} (one of {len(names)})" if len(names) > 1 else names[0]


def types_json(kinds: Kinds, channel: str = "") -> dict[str, object]:
    """Return types for JSON: the likeliest, as text, and all that they may be."""
    likeliest = kinds_text(tuple(names[:1] for names in kinds))
    names = dict.fromkeys(name for names in kinds for name in names if name != UNKNOWN)
    return {"type": None if is_of_lcm(channel) else likeliest, "types": list(names)}


def topic_kinds(topic: Topic) -> Kinds:
    """Return a topic's types: as announced, else from the fingerprints seen.

    Other types that plain programs send are included, as "unknown type" if unknown.
    """
    if is_of_lcm(topic.name):
        return ()
    declared = {f for _, end in topic.publishers + topic.subscribers for f in end.fingerprints}
    plain = (f for seen in topic.foreign if declared and not seen.types for f in seen.fingerprints)
    odd = [seen_kinds([f], topic.name) or ((UNKNOWN,),) for f in plain if f not in declared]
    known = tuple((name,) for name in topic.types) or seen_kinds(topic.fingerprints, topic.name)
    return tuple({names[0]: names for kinds in (known, *odd) for names in kinds}.values())


def seen_kinds(fingerprints: Iterable[int], channel: str) -> Kinds:
    """Return the types that messages with fingerprints may have, without unknown ones."""
    found = (tuple(possible_types(value, channel)) for value in fingerprints)
    return tuple(dict.fromkeys(filter(None, found)))


def endpoint_types(end: Endpoint) -> list[str]:
    """Return an endpoint's types: announced, else those of its messages, as of a program."""
    return list(end.types or chain(*seen_kinds(end.fingerprints, end.topic)))


def fingerprint_rows(topic: Topic) -> list[str]:
    """Return the fingerprints seen on a topic, a line each; one line if they keep changing."""
    if is_of_lcm(topic.name):
        return []
    if len(topic.fingerprints) > 1 and not seen_kinds(topic.fingerprints, topic.name):
        return [
            "Fingerprint: changes from message to message, as in data that is not an LCM message"
        ]

    def meaning(value: int) -> str:
        names = possible_types(value, topic.name)
        return " or ".join(names) or UNKNOWN + like_text(value, topic.name, topic.types)

    return [f"Fingerprint: {value:#018x} ({meaning(value)})" for value in topic.fingerprints]


def behind_json(node: NodeInfo) -> dict[str, object]:
    """Return the bus of a node behind relays, and the relays, nearest first, for JSON."""
    return {"bus": node.bus, "relays": [step.relay for step in node.path]} if node.path else {}


def node_text(node: NodeInfo) -> str:
    """Return a node with its host and pid."""
    stale = f", stale: {node.stale}" if node.stale else ""
    return f"{node.name} ({host_text(node)}, pid {node.pid}{stale})"


def host_text(node: NodeInfo) -> str:
    """Return a node's computer; if it is another one, with its address: "ada at 10.0.0.1".

    A container of this computer is named as one.
    """
    address = address_of(node)
    place = f"{node.host} at {address}" if address else node.host
    if node.path:
        return f"{place}, on {behind_text(node)}"
    is_of_container = node.host == socket.gethostname() and is_contained(node)
    is_elsewhere = address or node.is_recorded or not is_of_container
    return place if is_elsewhere else f"{place}, in another container"


def behind_text(node: NodeInfo) -> str:
    """Return the bus of a node behind relays: "udpm://... by /relay_ada_7700"."""
    return f"{node.bus} by {', '.join(step.relay for step in node.path)}"


def listed_node(node: NodeInfo) -> str:
    """Return a node's name, and the reason why it is stale."""
    state = [f"stale: {node.stale}"] if node.stale else []
    state += [f"on {node.bus}"] if node.path else []
    return f"{node.name} ({', '.join(state)})" if state else node.name


def callback_errors(node: NodeInfo) -> list[str]:
    """Return the errors that the node's callbacks raised, newest first."""
    return [
        f"{error.callback} raised {error.exception}"
        f" {'once' if error.count == 1 else f'{error.count} times'}, {error.place}: {error.message}"
        for error in reversed(node.errors)
    ]


def all_callback_errors(graph: Graph) -> list[str]:
    """Return the errors of the callbacks of all living nodes, each with the node's name."""
    living = (node for node in graph.nodes if not node.stale)
    return [f"{node.name}: {text}" for node in living for text in callback_errors(node)]


def program_texts(traffic: Sequence[Traffic]) -> list[str]:
    """Return the programs behind senders that are not nodes, as far as the system shows them."""
    senders = [seen.sender for seen in traffic]
    here = (sender for sender in senders if sender and sender.port and not sender.name)
    table = SocketTable.read() if any(is_local(one.address) for one in here) else SocketTable()
    return [_program_text(seen, table) for seen in traffic]


def _program_text(seen: Traffic, table: SocketTable) -> str:
    sender = seen.sender
    if sender is None:
        return "a plain LCM program (this kind of bus does not identify senders)"
    if sender.name:
        by = f"a program at {sender} by {seen.observer}"
        return by if seen.observer else f"{sender.name} (when it was recorded)"
    if not sender.port:
        place = "of this computer" if is_local(sender.address) else "on another computer"
        return f"a program {place} (session {sender} of Zenoh)"
    if not is_local(sender.address):
        return f"a program on {sender.address}, port {sender.port}"
    found = table.processes(sender)
    if found.only:
        called = shortened(found.only.command, LONGEST_COMMAND)
        return f"{called} (pid {found.only.pid}, port {sender.port})"
    return f"a program of this computer, port {sender.port}{candidates_text(found.candidates)}"


def candidates_text(processes: Sequence[Process]) -> str:
    """Return ": maybe …" with the processes that may be the program; "" for none."""
    names = [f"{shortened(one.command, LONGEST_COMMAND)} (pid {one.pid})" for one in processes]
    return f": maybe {' or '.join(names)}" if names else ""


class Computers:
    """The names of the computers on which ``nodes``, all known nodes, run.

    The names are those that the nodes announce. If a name is unknown, or two computers have the
    same one, the address is shown.
    """

    def __init__(self, nodes: Iterable[NodeInfo]) -> None:
        self._own = socket.gethostname()
        self._names: dict[str, str] = {}  # names of other computers, by address
        for node in nodes:
            if address := address_of(node):
                self._names.setdefault(address, node.host)
        names = [self._own, *self._names.values()]
        self._twice = {self._own, *(name for name in names if names.count(name) > 1)}

    def of(self, node: NodeInfo) -> str:
        """Return the name of the computer that a node is on."""
        if node.path:
            return f"{node.host} ({node.bus})"
        address = address_of(node)
        return f"{node.host} ({address})" if address and node.host in self._twice else node.host

    def nodes_on(self, host: str, nodes: Iterable[NodeInfo]) -> list[NodeInfo]:
        """Return the nodes on a computer, given by its name or address.

        Raises:
            LcmtoolsError: No node is on this computer.
        """
        wanted = self._own if host in ("localhost", "127.0.0.1") else host
        known = {one: (one.host, self.of(one), one.sender and one.sender.address) for one in nodes}
        if not (found := [node for node, names in known.items() if wanted in names]):
            hint = did_you_mean(host, {node.host for node in known})
            what = f"no node runs on machine {host}"
            raise LcmtoolsError(what, hint or "lcmtools node machine lists the machines")
        return found

    def of_traffic(self, traffic: Traffic) -> str:
        """Return the name of the computer that a sender is on."""
        if traffic.sender is None:
            return "unknown"
        address = traffic.sender.address
        if traffic.observer:
            return f"{address or 'unknown'}{f' ({traffic.bus})' if traffic.bus else ''}"
        if is_local(address):
            return self._own
        name = self._names.get(address, address)
        return f"{name} ({address})" if name in self._twice else name


def address_of(node: NodeInfo) -> str:
    """Return the address of a node's computer; "" for this computer, on Zenoh, and if unknown."""
    sender = node.sender
    return "" if sender is None or not sender.port or is_local(sender.address) else sender.address


def by_computer(topics: Iterable[Topic]) -> dict[str, list[Topic]]:
    """Return the part of each topic on each computer, sorted by the computer's name."""
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
    def there(ends: Ends) -> Ends:
        return tuple(end for end in ends if computers.of(end[0]) == name)

    foreign = tuple(seen for seen in topic.foreign if computers.of_traffic(seen) == name)
    publishers = there(topic.publishers)
    return topic._replace(
        publishers=publishers,
        subscribers=there(topic.subscribers),
        traffic=topic.traffic if publishers else foreign,
        foreign=foreign,
    )
