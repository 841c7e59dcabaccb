"""What is known of a bus as a diagram: announced nodes, programs seen from outside, their topics.

Belongs here: what counts as a member or an edge. Must not know what of it is drawn, nor how.
"""

import socket
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from lcmtools.cli.describe import seen_types
from lcmtools.graph.drawing.diagram import Channel, Diagram, Edge, Flow, Member
from lcmtools.graph.model import Endpoint, Graph, Node, Role, Topic, Traffic
from lcmtools.observe.programs import Program, is_here

_FLOWS = {
    Role.PUBLISHER: Flow.PUBLISHES,
    Role.SUBSCRIBER: Flow.SUBSCRIBES,
    Role.SERVICE: Flow.SERVES,
    Role.CLIENT: Flow.CALLS,
}
_INTO_CHANNEL = (Flow.PUBLISHES, Flow.CALLS)


@dataclass(frozen=True, slots=True)
class _Use:
    """That a member uses a channel.

    Attributes:
        member: The member's id.
        name: The topic or service.
        flow: What the member does with it.
        messages: As the member counts them, or as seen.
        senders_rate: How often they were seen to come from it [Hz]; None where that is not known.
    """

    member: str
    name: str
    flow: Flow
    messages: int
    senders_rate: float | None = None

    @property
    def is_service(self) -> bool:
        """Whether the channel is a service."""
        return self.flow in (Flow.CALLS, Flow.SERVES)


class _Known:
    """What is known of each channel, looked up once for all of them."""

    def __init__(self, graph: Graph, uses: Iterable[_Use]) -> None:
        self._types: dict[tuple[str, bool], dict[str, None]] = {}
        self._traffic: dict[str, list[Traffic]] = {}
        self._sent: Counter[str] = Counter()
        for role in (Role.PUBLISHER, Role.SUBSCRIBER, Role.SERVICE, Role.CLIENT):
            for node in graph.nodes:
                self._hear(endpoint for endpoint in node.endpoints if endpoint.role is role)
        for seen in graph.traffic:
            self._traffic.setdefault(seen.channel, []).append(seen)
        for use in uses:
            if use.flow is Flow.PUBLISHES:
                self._sent[use.name] += use.messages

    def types(self, name: str, *, is_service: bool) -> tuple[str, ...]:
        """The types of a channel: as announced, the publishers' first; else as seen."""
        declared = tuple(self._types.get((name, is_service), ()))
        if declared or is_service:
            return declared
        return tuple(seen_types(Topic(name, (), (), tuple(self._traffic.get(name, ())), ())))

    def messages(self, name: str) -> int:
        """How many messages were announced as sent on a topic, or seen."""
        return max(self._sent[name], sum(seen.messages for seen in self._traffic.get(name, ())))

    def _hear(self, endpoints: Iterable[Endpoint]) -> None:
        for endpoint in endpoints:
            key = (endpoint.topic, endpoint.role in (Role.SERVICE, Role.CLIENT))
            if endpoint.type:
                self._types.setdefault(key, {})[endpoint.type] = None


def diagram_of(
    graph: Graph, programs: Sequence[Program], rates: Mapping[str, float] | None
) -> Diagram:
    """All that is known, hidden names and tools too.

    Args:
        graph: What is announced and seen.
        programs: What of that are no nodes.
        rates: Messages per second [Hz], by topic; None where they were not measured.
    """
    nodes = {f"n{number}": node for number, node in enumerate(graph.nodes, 1)}
    others = {f"n{number}": p for number, p in enumerate(programs, len(nodes) + 1)}
    uses = [
        *(use for id_, node in nodes.items() for use in _of_node(id_, node, graph)),
        *(use for id_, program in others.items() for use in _of_program(id_, program)),
    ]
    topics = sorted({use.name for use in uses if not use.is_service})
    services = sorted({use.name for use in uses if use.is_service})
    ids = {(name, False): f"t{number}" for number, name in enumerate(topics, 1)}
    ids.update({(name, True): f"s{number}" for number, name in enumerate(services, 1)})
    measured, known = rates or {}, _Known(graph, uses)
    return Diagram(
        (
            *(_node_member(id_, node) for id_, node in nodes.items()),
            *(_program_member(id_, program) for id_, program in others.items()),
        ),
        (
            *(_topic(ids[name, False], name, known, measured.get(name)) for name in topics),
            *(
                Channel(ids[name, True], name, known.types(name, is_service=True), is_service=True)
                for name in services
            ),
        ),
        tuple(_edges(uses, ids, rates)),
    )


def _node_member(id_: str, node: Node) -> Member:
    return Member(
        id_,
        node.name,
        host=node.host,
        is_here=is_here(node),
        pid=node.pid,
        command=node.command,
        is_tool=node.tool,
        publishes=any(endpoint.role is Role.PUBLISHER for endpoint in node.endpoints),
        stale=node.stale.value,
    )


def _program_member(id_: str, program: Program) -> Member:
    process = program.process
    is_local = process is not None or not program.address or bool(program.user)
    command = process.command if process else ""
    return Member(
        id_,
        command,
        host=socket.gethostname() if is_local else program.address,
        is_here=is_local,
        pid=process.pid if process else None,
        command=command,
        user=program.user,
        is_node=False,
        listens=bool(program.listens),
    )


def _of_node(id_: str, node: Node, graph: Graph) -> Iterator[_Use]:
    """What a node announces, each topic and role once."""
    senders = node.senders()
    seen: dict[str, list[Traffic]] = {}
    for traffic in graph.traffic:
        if traffic.sender in senders:
            seen.setdefault(traffic.channel, []).append(traffic)
    counts: dict[tuple[str, Role], int] = {}
    for endpoint in node.endpoints:
        key = (endpoint.topic, endpoint.role)
        counts[key] = counts.get(key, 0) + endpoint.messages
    for (name, role), messages in sorted(counts.items()):
        rate = _rate(seen.get(name, [])) if role is Role.PUBLISHER else None
        yield _Use(id_, name, _FLOWS[role], messages, rate)


def _of_program(id_: str, program: Program) -> Iterator[_Use]:
    for name in program.channels:
        seen = [traffic for traffic in program.traffic if traffic.channel == name]
        messages = sum(traffic.messages for traffic in seen)
        yield _Use(id_, name, Flow.PUBLISHES, messages, _rate(seen))


def _rate(seen: Iterable[Traffic]) -> float | None:
    """How often messages come from all the ports of one member [Hz]."""
    rates = [rate for traffic in seen if (rate := traffic.rate()) is not None]
    return sum(rates) if rates else None


def _topic(id_: str, name: str, known: _Known, rate: float | None) -> Channel:
    types = known.types(name, is_service=False)
    return Channel(id_, name, types, messages=known.messages(name), rate=rate)


def _edges(
    uses: Iterable[_Use], ids: Mapping[tuple[str, bool], str], rates: Mapping[str, float] | None
) -> Iterator[Edge]:
    """Where messages flow. What comes over a topic is its one publisher's."""
    known = list(uses)
    publishers = Counter(use.name for use in known if use.flow is Flow.PUBLISHES)
    for use in known:
        channel, rate = ids[use.name, use.is_service], None
        if rates is not None and use.flow is Flow.PUBLISHES:
            is_alone = publishers[use.name] == 1
            rate = rates.get(use.name) if is_alone else use.senders_rate
        if use.flow in _INTO_CHANNEL:
            yield Edge(use.member, channel, use.flow, use.messages, rate)
        else:
            yield Edge(channel, use.member, use.flow, use.messages)
