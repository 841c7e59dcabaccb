"""A bus as a diagram: announced nodes, observed programs, and their topics.

Determines the members and edges. Must not know which of them are drawn, or how.
"""

import socket
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain

from lcmtools.graph.drawing.diagram import Channel, Diagram, Edge, Member, Relation
from lcmtools.graph.model import Graph, NodeInfo, Role, Traffic
from lcmtools.observe.reading.senders import Program, is_here
from lcmtools.observe.reports.describe import one_of, topic_kinds

_FLOWS = {
    Role.PUBLISHER: Relation.PUBLISHES,
    Role.SUBSCRIBER: Relation.SUBSCRIBES,
    Role.SERVICE: Relation.SERVES,
    Role.CLIENT: Relation.CALLS,
}
_Name = tuple[str, bool]  # name of a channel; True for a service


@dataclass(frozen=True, slots=True)
class _Use:
    """A member's use of a channel; its observed rate [Hz], None if unknown."""

    member: str
    name: str
    relation: Relation
    messages: int
    rate: float | None = None

    @property
    def channel(self) -> _Name:
        return self.name, self.relation in (Relation.CALLS, Relation.SERVES)


def diagram_of(
    graph: Graph, programs: Sequence[Program], rates: Mapping[str, float] | None
) -> Diagram:
    """Return the diagram of a graph and its plain programs, with hidden names and tools.

    ``rates`` are message rates [Hz] by topic; None if not measured.
    """
    nodes = {f"n{number}": node for number, node in enumerate(graph.nodes, 1)}
    others = {f"n{number}": p for number, p in enumerate(programs, len(nodes) + 1)}
    uses = [
        *(use for id_, node in nodes.items() for use in _of_node(id_, node, graph)),
        *(use for id_, program in others.items() for use in _of_program(id_, program)),
    ]
    members = [_node_member(id_, node) for id_, node in nodes.items()]
    members += [_program_member(id_, program) for id_, program in others.items()]
    channels = _channels(graph, uses, rates or {})
    ids = {(channel.name, channel.is_service): channel.id for channel in channels}
    return Diagram(tuple(members), tuple(channels), tuple(_edges(uses, ids, rates)))


def _node_member(id_: str, node: NodeInfo) -> Member:
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
    recorded = (seen.sender.name for seen in program.traffic if seen.sender)
    return Member(
        id_,
        command or next(recorded, ""),
        host=socket.gethostname() if is_local else program.address,
        is_here=is_local,
        pid=process.pid if process else None,
        command=command,
        user=program.user,
        is_node=False,
        listens=bool(program.listens),
    )


def _of_node(id_: str, node: NodeInfo, graph: Graph) -> Iterator[_Use]:
    senders = node.senders()
    seen = _by_channel(traffic for traffic in graph.traffic if traffic.sender in senders)
    counts: Counter[tuple[str, Role]] = Counter()
    for endpoint in node.endpoints:
        counts[endpoint.topic, endpoint.role] += endpoint.messages
    for (name, role), messages in sorted(counts.items()):
        rate = _rate(seen.get(name, [])) if role is Role.PUBLISHER else None
        yield _Use(id_, name, _FLOWS[role], messages, rate)


def _of_program(id_: str, program: Program) -> Iterator[_Use]:
    for name, seen in sorted(_by_channel(program.traffic).items()):
        messages = sum(traffic.messages for traffic in seen)
        yield _Use(id_, name, Relation.PUBLISHES, messages, _rate(seen))


def _by_channel(traffic: Iterable[Traffic]) -> dict[str, list[Traffic]]:
    found: dict[str, list[Traffic]] = defaultdict(list)
    for seen in traffic:
        found[seen.channel].append(seen)
    return found


def _rate(seen: Iterable[Traffic]) -> float | None:
    rates = [rate for traffic in seen if (rate := traffic.rate()) is not None]
    return sum(rates) if rates else None


def _channels(graph: Graph, uses: Sequence[_Use], rates: Mapping[str, float]) -> list[Channel]:
    sent: Counter[str] = Counter()
    for use in uses:
        if use.relation is Relation.PUBLISHES:
            sent[use.name] += use.messages
    topics = sorted({use.name for use in uses if not use.channel[1]})
    services = sorted({use.name for use in uses if use.channel[1]})
    found = []
    for number, name in enumerate(topics, 1):
        topic = graph.topic(name)
        kinds = topic_kinds(topic)
        shown, known = tuple(map(one_of, kinds)), tuple(dict.fromkeys(chain(*kinds)))
        messages = max(sent[name], sum(one.messages for one in topic.traffic))
        rate = rates.get(name)
        channel = Channel(f"t{number}", name, known, messages=messages, rate=rate, shown=shown)
        found.append(channel)
    types: dict[str, dict[str, None]] = defaultdict(dict)  # types by service; an ordered set each
    for role in (Role.SERVICE, Role.CLIENT):
        for end in (end for node in graph.nodes for end in node.having(role) if end.type):
            types[end.topic][end.type] = None
    for number, name in enumerate(services, 1):
        found.append(Channel(f"s{number}", name, tuple(types[name]), is_service=True))
    return found


def _edges(
    uses: Sequence[_Use], ids: Mapping[_Name, str], rates: Mapping[str, float] | None
) -> Iterator[Edge]:
    publishers = Counter(use.name for use in uses if use.relation is Relation.PUBLISHES)
    for use in uses:
        channel, rate = ids[use.channel], None
        if rates is not None and use.relation is Relation.PUBLISHES:
            rate = rates.get(use.name) if publishers[use.name] == 1 else use.rate
        if use.relation in (Relation.PUBLISHES, Relation.CALLS):
            yield Edge(use.member, channel, use.relation, use.messages, rate)
        else:
            yield Edge(channel, use.member, use.relation, use.messages)
