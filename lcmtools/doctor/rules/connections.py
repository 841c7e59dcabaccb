"""Rules about subscriptions without publishers, and publications without subscribers."""

from collections.abc import Iterator

from lcmtools.doctor.connecting import Loose, Way, is_simulator, loose_ends, ways, ways_out
from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import Finding, Severity, Statement, cases, rule, state
from lcmtools.graph.model import Role


@rule("unconnected-subscriptions", "start the node with __ns:=/NAMESPACE or with OLD:=NEW")
def subscriptions_have_publishers(evidence: Evidence) -> Iterator[Finding]:
    """Every subscription has a publisher.

    One without is often in another namespace, has a slightly different name, or its publisher was
    not started.
    """
    # other rules report topics of other buses, and of publishers that hang
    elsewhere = {topic for process in evidence.processes for topic in process.topics}
    elsewhere |= evidence.stale_published
    loose = {
        node: kept
        for node, endpoints in loose_ends(evidence.graph, Role.SUBSCRIBER).items()
        if (kept := [one for one in endpoints if one.topic not in elsewhere])
    }
    found = ways(evidence.graph, loose, _senders(evidence))
    return cases("unconnected-subscriptions", _facts(loose), *(way.remedy for way in found))


@rule(
    "unconnected-publications",
    "start the node with OLD:=NEW, where a subscriber is missing",
    Severity.NOTE,
)
def publications_have_subscribers(evidence: Evidence) -> Iterator[Finding]:
    """Every publication has a subscriber.

    One without is seldom a fault. Programs that are no nodes do not announce their subscriptions:
    where one listens, nothing is reported. Neither are sensors of a simulator, publications that
    would connect an unconnected subscription, and topics of a node that was killed or hangs.
    """
    if any(not listener.is_node and not listener.is_tool for listener in evidence.listeners):
        return
    graph = evidence.graph
    proposed = proposed_ways(evidence)
    known = {(way.publisher, way.channel) for way in proposed}
    moving = {way.listener for way in proposed}
    known |= {(node.id, topic) for node in graph.nodes for topic in evidence.stale_subscribed}
    loose = {
        node: kept
        for node, endpoints in loose_ends(graph, Role.PUBLISHER).items()
        if not is_simulator(node)
        and node.id not in moving
        and (kept := [one for one in endpoints if (node.id, one.topic) not in known])
    }
    remedies = [
        remedy
        for node, endpoints in loose.items()
        for one in endpoints
        for remedy in ways_out(graph, node, one)
    ]
    kind = "unconnected-publications"
    yield from cases(kind, _facts(loose), *remedies, severity=Severity.NOTE)


def missed_topics(evidence: Evidence) -> set[str]:
    """The topics of subscriptions without a publisher."""
    loose = loose_ends(evidence.graph, Role.SUBSCRIBER)
    return {endpoint.topic for endpoints in loose.values() for endpoint in endpoints}


def proposed_ways(evidence: Evidence) -> list[Way]:
    """The remedies for unconnected subscriptions: other rules need not repeat them."""
    loose = loose_ends(evidence.graph, Role.SUBSCRIBER)
    return ways(evidence.graph, loose, _senders(evidence))


def _senders(evidence: Evidence) -> dict[str, str]:
    """The senders of the channels, for people."""
    return {stream.channel: stream.name for stream in evidence.streams}


def _facts(loose: Loose) -> Iterator[Statement]:
    for node, endpoints in loose.items():
        yield state("node-topics", node=node, topics=[endpoint.topic for endpoint in endpoints])
