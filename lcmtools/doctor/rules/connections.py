"""Rules about who is connected to whom."""

from collections.abc import Iterator

from lcmtools.doctor.connecting import Loose, Way, is_simulator, loose_ends, ways, ways_out
from lcmtools.doctor.model import Evidence, Finding, Severity, rule
from lcmtools.graph.model import Role


@rule(
    "unconnected-subscriptions",
    Severity.WARNING,
    "start the node with __ns:=/NAMESPACE or with OLD:=NEW",
)
def subscriptions_are_fed(evidence: Evidence) -> Iterator[Finding]:
    """Every subscription has a publisher.

    One without is often in another namespace, has a slightly different name, or its publisher was
    not started.
    """
    # what is published on another bus, or would be by a node that hangs, is said by other rules
    there = {topic for process in evidence.processes for topic in process.topics}
    there |= evidence.hushed
    loose = {
        node: kept
        for node, endpoints in loose_ends(evidence.graph, Role.SUBSCRIBER).items()
        if (kept := [one for one in endpoints if one.topic not in there])
    }
    if loose:
        yield Finding(
            "unconnected-subscriptions",
            Severity.WARNING,
            "The following node subscriptions are unconnected:",
            tuple(_tree(loose)),
            tuple(way.text for way in ways(evidence.graph, loose, _names(evidence))),
        )


@rule(
    "unconnected-publications",
    Severity.NOTE,
    "start the node with OLD:=NEW, where somebody should hear it",
)
def publications_are_heard(evidence: Evidence) -> Iterator[Finding]:
    """Every publication has a subscriber.

    One that has none is seldom a fault. Programs that are no nodes do not announce what they hear:
    where one listens, nothing is said; nor of what a simulator offers, nor of what would connect an
    unconnected subscription, nor of what a node listened to that was killed or hangs.
    """
    if any(not listener.is_node and not listener.is_tool for listener in evidence.listeners):
        return
    graph = evidence.graph
    said = said_ways(evidence)
    known = {(way.publisher, way.channel) for way in said}
    moving = {way.listener for way in said}
    known |= {(node.id, topic) for node in graph.nodes for topic in evidence.deafened}
    loose = {
        node: kept
        for node, endpoints in loose_ends(graph, Role.PUBLISHER).items()
        if not is_simulator(node)
        and node.id not in moving
        and (kept := [one for one in endpoints if (node.id, one.topic) not in known])
    }
    if loose:
        remedies = dict.fromkeys(
            text
            for node, endpoints in loose.items()
            for one in endpoints
            for text in ways_out(graph, node, one)
        )
        yield Finding(
            "unconnected-publications",
            Severity.NOTE,
            "The following node publications have no announced subscriber:",
            tuple(_tree(loose)),
            tuple(remedies),
        )


def missed_topics(evidence: Evidence) -> set[str]:
    """The topics that nodes wait for in vain."""
    loose = loose_ends(evidence.graph, Role.SUBSCRIBER)
    return {endpoint.topic for endpoints in loose.values() for endpoint in endpoints}


def said_ways(evidence: Evidence) -> list[Way]:
    """What is said of unconnected subscriptions: other rules need not repeat it."""
    loose = loose_ends(evidence.graph, Role.SUBSCRIBER)
    return list(ways(evidence.graph, loose, _names(evidence)))


def _names(evidence: Evidence) -> dict[str, str]:
    """Who sends on a channel, for people."""
    return {stream.channel: stream.name for stream in evidence.streams}


def _tree(loose: Loose) -> Iterator[str]:
    """As roswtf lists them: a node, and its topics below it."""
    for node, endpoints in loose.items():
        yield f" * {node.name}:"
        for endpoint in endpoints:
            yield f"   * {endpoint.topic}"
