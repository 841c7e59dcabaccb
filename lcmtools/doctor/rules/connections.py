"""Rules about what connects publishers and subscribers: topics with both, and good names."""

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator
from itertools import combinations, groupby

from lcmtools.doctor.connecting import Connecting, End, Way, loose_ends
from lcmtools.doctor.evidence import Evidence, LcmProcess, channel_names, derived
from lcmtools.doctor.findings import Finding, Severity, Statement, found, rule, state
from lcmtools.graph.model import Role
from lcmtools.observe.simulators import is_simulator

_IS_PATTERN = "liblcm takes it for a pattern, which does not match the name"
_LONG_NAME = 60  # bytes; LCM takes 63


@rule("unconnected-subscriptions", "start the node with __ns:=/NAMESPACE or with OLD:=NEW")
def subscriptions_have_publishers(evidence: Evidence) -> Iterator[Finding]:
    """Every subscription has a publisher.

    One without is often in another namespace, has a slightly different name, or its publisher was
    not started. A note if a program that is not a node may publish it rarely.
    """
    # other rules report topics of other buses, and of publishers that hang
    elsewhere = {topic for process in evidence.processes for topic in process.topics}
    elsewhere |= evidence.stale_published
    loose = [
        (node, end) for node, end in loose_subscriptions(evidence) if end.topic not in elsewhere
    ]
    remedies = [way.remedy for way in _connecting(evidence).ways(loose)]
    facts, severity = list(_facts(loose)), Severity.WARNING
    if not remedies:
        topics = dict.fromkeys(end.topic for _, end in loose)
        remedies.append(state("start-publisher", topics=topics))
        if facts and (quiet := quiet_programs(evidence)):
            facts += [state("may-publish", process=one) for one in quiet]
            severity = Severity.NOTE
    return found("unconnected-subscriptions", facts, *remedies, severity=severity)


@rule(
    "unconnected-publications",
    "start the node with OLD:=NEW, where a subscriber is missing",
    Severity.NOTE,
)
def publications_have_subscribers(evidence: Evidence) -> Iterator[Finding]:
    """Every publication has a subscriber.

    One without is seldom a fault. Programs that are not nodes do not announce their subscriptions:
    if one listens, nothing is reported. Not reported either are sensors of a simulator,
    publications that would connect an unconnected subscription, topics of a node that was killed or
    hangs, and topics that a node on another bus waits for.
    """
    if any(not listener.is_node and not listener.is_tool for listener in evidence.listeners):
        return
    proposed = proposed_ways(evidence)
    known = {(way.publisher, way.channel) for way in proposed}
    moving = {way.listener for way in proposed}
    awaited = {topic for process in evidence.processes for topic in process.awaited}
    loose = [
        (node, end)
        for node, end in loose_ends(evidence.graph, Role.PUBLISHER)
        if (node.id, end.topic) not in known
        if end.topic not in awaited | evidence.stale_subscribed
        if node.id not in moving and not is_simulator(node)
    ]
    ways_out = _connecting(evidence).ways_out
    remedies = (remedy for end in loose for remedy in ways_out(*end))
    yield from found("unconnected-publications", _facts(loose), *remedies)


def quiet_programs(evidence: Evidence) -> list[LcmProcess]:
    """The programs on this bus that are no nodes, do not listen, and sent nothing in the look."""
    known = {one.pid for one in evidence.listeners} | {one.pid for one in evidence.streams}
    known |= {node.pid for node in evidence.own_nodes()}
    return [p for p in evidence.processes if not p.bus and p.pid not in known]


def missed_topics(evidence: Evidence) -> set[str]:
    """The topics of subscriptions without a publisher."""
    return {end.topic for _, end in loose_subscriptions(evidence)}


@derived
def loose_subscriptions(evidence: Evidence) -> list[End]:
    """The subscriptions of live nodes without a publisher."""
    nodes = {node.pid for node in evidence.own_nodes()}
    plain = (one for one in evidence.processes if not one.bus and one.pid not in nodes)
    beside_plain = evidence.has_others() or any(plain)
    return loose_ends(evidence.graph, Role.SUBSCRIBER, beside_plain=beside_plain)


@derived
def proposed_ways(evidence: Evidence) -> list[Way]:
    """The remedies for unconnected subscriptions: other rules need not repeat them."""
    return _connecting(evidence).ways(loose_subscriptions(evidence))


@derived
def _connecting(evidence: Evidence) -> Connecting:
    return Connecting(evidence.graph, channel_names(evidence))


def _facts(loose: Iterable[End]) -> Iterator[Statement]:
    for _, group in groupby(loose, key=lambda end: end[0].id):
        ends = list(group)
        yield state("node-topics", node=ends[0][0], topics=dict.fromkeys(e.topic for _, e in ends))


@rule("names", "use letters, digits, _ and /, at most 63 bytes, and the same everywhere")
def names_are_good(evidence: Evidence) -> Iterator[Finding]:
    """Channels have names that every program can subscribe to, and no two names look the same.

    liblcm matches names as UTF-8 text: other names never arrive. A name has at most 63 bytes.
    """
    proposed = {way.channel for way in proposed_ways(evidence)}  # reported with its subscription
    senders = {s.channel: s.name for s in evidence.streams if s.channel not in proposed}
    bad = {channel: reason for channel in senders if (reason := _fault(channel))}
    odd = (
        state("odd-channel", topic=channel, sender=senders[channel], reason=reason)
        for channel, reason in bad.items()
    )
    patterns = [channel for channel, reason in bad.items() if reason == _IS_PATTERN]
    remedies = [state("subscribe-to-pattern", pattern=re.escape(c)) for c in patterns[:1]]
    yield from found("unusable-names", odd, "plain-name", *remedies)
    long = [c for c in senders if len(c.encode("utf-8", "surrogateescape")) >= _LONG_NAME]
    note = Severity.NOTE
    facts = (state("channel", topic=channel, sender=senders[channel]) for channel in long)
    yield from found("long-names", facts, "shorter-name", severity=note)
    alike: dict[str, list[str]] = defaultdict(list)
    for channel in sorted(senders):
        alike[channel.casefold().strip(" /")].append(channel)
    pairs = (pair for same in alike.values() for pair in combinations(same, 2))
    two = (
        state("two-channels", topic=a, sender=senders[a], other_topic=b, other_sender=senders[b])
        for a, b in pairs
    )
    yield from found("similar-names", two, "same-name", severity=note)


def _fault(channel: str) -> str:
    """The reason why few programs can subscribe to a channel; "" where all can."""
    if not channel:
        return "it is empty"
    if any("\udc80" <= character <= "\udcff" for character in channel):
        return "it is not UTF-8, and liblcm delivers it to no subscription"
    if not channel.isprintable():
        return "it has characters that are not printed"
    if channel != channel.strip():
        return "it begins or ends with a space"
    return "" if _matches_itself(channel) else _IS_PATTERN


def _matches_itself(channel: str) -> bool:
    """Return whether the name, which liblcm takes as a pattern, matches the name."""
    if channel.startswith("#!"):  # LCM's own
        return True
    try:
        return re.fullmatch(channel, channel) is not None
    except re.error:
        return False
