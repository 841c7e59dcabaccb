"""Rules about what connects publishers and subscribers: topics with both, and good names."""

import re
from collections.abc import Iterator
from itertools import combinations

from lcmtools.doctor.connecting import Loose, Way, is_simulator, loose_ends, ways, ways_out
from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import Finding, Severity, Statement, cases, rule, state
from lcmtools.doctor.renaming import are_near
from lcmtools.graph.model import Role

_LONG_NAME = 60  # bytes; LCM takes 63


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


@rule("names", "use letters, digits, _ and /, at most 63 bytes, and the same everywhere")
def names_are_good(evidence: Evidence) -> Iterator[Finding]:
    """Channels have names that every program can subscribe to, and no two that look the same.

    liblcm matches names as UTF-8 text: others never arrive. It carries at most 63 bytes.
    """
    proposed = {way.channel for way in proposed_ways(evidence)}  # reported with its subscription
    senders = {s.channel: s.name for s in evidence.streams if s.channel not in proposed}
    bad = [c for c in senders if not c.isprintable() or c != c.strip() or not _matches_itself(c)]
    bad += [c for c in senders if not c]

    def facts(kind: str, channels: list[str]) -> Iterator[Statement]:
        return (state(kind, topic=name, sender=senders[name]) for name in channels)

    patterns = [c for c in bad if c and not _matches_itself(c)]
    remedies = [state("subscribe-to-pattern", pattern=re.escape(c)) for c in patterns[:1]]
    yield from cases("unusable-names", facts("odd-channel", bad), "plain-name", *remedies)
    long = [c for c in senders if len(c.encode("utf-8", "surrogateescape")) >= _LONG_NAME]
    note = Severity.NOTE
    yield from cases("long-names", facts("channel", long), "shorter-name", severity=note)
    alike = (
        state("two-channels", topic=a, sender=senders[a], other_topic=b, other_sender=senders[b])
        for a, b in combinations(sorted(senders), 2)
        if _look_alike(a, b)
    )
    yield from cases("similar-names", alike, "same-name", severity=note)


def _matches_itself(channel: str) -> bool:
    """Return whether the name, which liblcm takes as a pattern, matches the name."""
    if channel.startswith("#!"):  # LCM's own
        return True
    try:
        return re.fullmatch(channel, channel) is not None
    except re.error:
        return False


def _look_alike(one: str, other: str) -> bool:
    """Return whether two names differ in case, slashes or spaces only."""
    first, second = one.casefold().strip(" /"), other.casefold().strip(" /")
    return first == second and are_near(one, other)
