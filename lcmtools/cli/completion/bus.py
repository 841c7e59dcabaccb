"""Completers that look at the bus: topics, nodes, namespaces, services, parameters, robots."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from lcmtools.cli.completion.situation import FILES, Candidate, Situation
from lcmtools.errors import LcmtoolsError
from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role
from lcmtools.names import base_name_of, is_hidden, namespace_of, spellings
from lcmtools.observe.simulators import is_simulator

if TYPE_CHECKING:  # most completions do without
    from lcmtools.types.lcmtools_msgs import Parameter

TOPIC = ("topic", "topics", "words")  # names of parameters that are topics
_DEFAULT_URL = "udpm://239.255.76.67:7667?ttl=0"


def urls(situation: Situation) -> Iterator[Candidate]:
    """Complete URLs: the bus of the environment, the default, and prefixes of other providers."""
    yield Candidate(situation.environment.get("LCM_DEFAULT_URL") or _DEFAULT_URL)
    yield Candidate(_DEFAULT_URL)
    yield from (
        Candidate(provider, is_open=True) for provider in ("tcpq://", "zenoh://", "file://")
    )


def topics(situation: Situation) -> Iterator[Candidate]:
    """Complete topics; hidden ones only if the typed word is hidden.

    A word without a slash may be a plain channel's name, or one in the namespace.
    """
    given = situation.all(*TOPIC)
    for name in situation.graph.topic_names():
        spelled = _relative(name, situation)
        if spelled not in given and _is_offered(name, situation):
            yield Candidate(spelled, " or ".join(types_of(situation.graph, name)))


def nodes(situation: Situation) -> Iterator[Candidate]:
    """Complete nodes by their full names, or by their last part if the word has no slash."""
    given = situation.all("node", "nodes")
    for node in situation.graph.nodes:
        name = node.name if situation.is_global else base_name_of(node.name)
        is_offered = is_hidden(situation.word) or not (node.is_hidden or node.tool)
        if is_offered and name not in given and node.name not in given:
            yield Candidate(name, f"{node.host}, pid {node.pid}")


def nodes_and_files(situation: Situation) -> Iterator[Candidate]:
    """Complete nodes, or files if no node begins with the word."""
    yield from nodes(situation)
    yield FILES


def nodes_after_file(situation: Situation) -> Iterator[Candidate]:
    """Complete a file, then nodes."""
    yield from nodes(situation) if situation.given.get("words") else [FILES]


def hosts(situation: Situation) -> Iterator[Candidate]:
    """Complete the computers that nodes run on."""
    yield from map(Candidate, sorted({node.host for node in situation.graph.nodes}))


def namespaces(situation: Situation) -> Iterator[Candidate]:
    """Complete the namespaces of topics and nodes, and their parents."""
    names = [*situation.graph.topic_names(), *(node.name for node in situation.graph.nodes)]
    found: set[str] = set()
    for name in names:
        while name.startswith("/") and (name := namespace_of(name)) != "/":
            found.add(name)
    for name in sorted(found):
        if _is_offered(name, situation):
            yield Candidate(name if situation.is_global else name.removeprefix("/"))


def names(situation: Situation) -> Iterator[Candidate]:
    """Complete all names: namespaces, topics, nodes."""
    given = situation.all("namespace", "excluded")
    found = (*namespaces(situation), *topics(situation), *nodes(situation))
    yield from (one for one in found if one.value not in given)


def robots(situation: Situation) -> Iterator[Candidate]:
    """Complete the namespaces of simulated robots."""
    found = {robot: node.name for node in situation.graph.nodes for robot in _robots_of(node)}
    for robot, simulator in sorted(found.items()):
        yield Candidate(robot if situation.is_global else robot.removeprefix("/"), simulator)


def services(situation: Situation) -> Iterator[Candidate]:
    """Complete services; hidden ones only if the typed word is hidden."""
    given = situation.all("service", "services")
    for endpoint in _services(situation):
        name = _relative(endpoint.topic, situation)
        if name not in given and _is_offered(endpoint.topic, situation):
            yield Candidate(name, endpoint.type)


def parameters(situation: Situation) -> Iterator[Candidate]:
    """Complete nodes, then the node's parameters, then the parameter's value.

    The name is rosparam's ("/driver/gain") or ros2's ("driver gain"); the node itself answers.
    """
    before = situation.all("words", "node", "name")
    if not before:
        yield from _node_or_parameter(situation)
        return
    for one in _parameters_of(_full_name(before[0], situation), situation):
        if len(before) == 1:
            yield Candidate(one.name, f"{one.type}, {one.value}")
        elif one.name == before[1]:
            yield Candidate(one.value, one.type)


def topic_meant(situation: Situation, word: str) -> str | None:
    """Return the topic on the bus that a word means, or None."""
    known = set(situation.graph.topic_names())
    return next((name for name in spellings(word, situation.namespace) if name in known), None)


def types_of(graph: Graph, name: str) -> tuple[str, ...]:
    """Return the types announced for a topic, or else the likeliest one for its fingerprint."""
    topic = graph.topic(name)
    if topic.types:
        return topic.types
    from lcmtools.messages.registry import candidates

    return tuple(one for f in topic.fingerprints for one in candidates(f, name)[:1])


def service_type(situation: Situation) -> str:
    """Return the type of the service before the cursor, or "" if no node announces it."""
    names = spellings(situation.first("service", "services"), situation.namespace)
    return next((one.type for one in _services(situation) if one.topic in names), "")


def _services(situation: Situation) -> list[Endpoint]:
    found = (one for node in situation.graph.nodes for one in node.having(Role.SERVICE))
    return sorted(found, key=lambda endpoint: endpoint.topic)


def _is_offered(name: str, situation: Situation) -> bool:
    return not is_hidden(name) or is_hidden(situation.word)


def _relative(name: str, situation: Situation) -> str:
    """Return a name in the form that the word begins: in full, or relative to the namespace."""
    if situation.is_global or not name.startswith("/"):
        return name
    return name.removeprefix(situation.namespace.rstrip("/")).removeprefix("/")


def _robots_of(node: NodeInfo) -> set[str]:
    """Return the namespaces that a simulator receives commands for."""
    if not is_simulator(node):
        return set()
    groups = {one.group for one in node.having(Role.SUBSCRIBER)}
    return {group.rpartition(" ")[2] for group in groups if group}


def _node_or_parameter(situation: Situation) -> Iterator[Candidate]:
    """Complete nodes, or the parameters of a complete node name that ends in a slash."""
    found = list(nodes(situation))
    yield from found
    name, slash, _ = situation.word.rpartition("/")
    if slash and name and not any(one.value.startswith(situation.word) for one in found):
        for one in _parameters_of(_full_name(name, situation), situation):
            yield Candidate(f"{name}/{one.name}", f"{one.type}, {one.value}")


def _full_name(name: str, situation: Situation) -> str:
    if name.startswith("/"):
        return name
    return next((node.name for node in situation.graph.named(name)), f"/{name}")


def _parameters_of(node: str, situation: Situation) -> "Sequence[Parameter]":
    from lcmtools.publish.quick_parameters import parameters_of

    try:
        return parameters_of(node, situation.url)
    except (LcmtoolsError, OSError):
        return ()
