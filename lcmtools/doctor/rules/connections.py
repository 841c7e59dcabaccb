"""Rules about connections: topics with publishers and subscribers, and valid names."""

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator
from itertools import combinations, groupby

from lcmtools.doctor import connecting
from lcmtools.doctor.evidence import Evidence, LcmProcess, channel_names, derived
from lcmtools.doctor.findings import Finding, Severity, Statement, finding, rule, state
from lcmtools.doctor.renaming import REMAPS
from lcmtools.doctor.rules.shared import simulator_ids
from lcmtools.graph.model import Role

_IS_PATTERN = "liblcm takes it for a pattern, which does not match the name"
MAY_PUBLISH = {"may-publish": "{process} (pid {process.pid}) uses LCM, and may publish rarely"}
_NODE_TOPICS = {"node-topics": "{node}:"}
_LONG_NAME = 60  # bytes; LCM takes 63


@rule(
    "unconnected-subscriptions",
    remedy="start the node with __ns:=/NAMESPACE or with OLD:=NEW",
    title="The following node subscriptions are unconnected:",
    facts=MAY_PUBLISH | _NODE_TOPICS,
    remedies={
        **connecting.CONNECTIONS,
        "start-publisher": "start a publisher of {topics:and}; to see what is published:"
        " `lcmtools list -v`",
    },
    evidence="announcements, with command lines; channels of all messages",
)
def subscriptions_have_publishers(evidence: Evidence) -> Iterator[Finding]:
    """Every subscription has a publisher.

    One without is often in another namespace, has a slightly different name, or its publisher was
    not started. A note if it has not come repeatedly before, and a program that is not a node may
    publish it rarely, or only a simulator waits, and nothing that is published may be meant for it.
    """
    # other rules report topics of other buses, and of publishers that hang
    others = missed_on_other_buses(evidence) | evidence.stale_published
    every = unconnected_subscriptions(evidence)
    unconnected = [(node, end) for node, end in every if end.topic not in others]
    remedies = [one.remedy for one in _connection_finder(evidence).suggestions(unconnected)]
    facts, severity = list(_facts(unconnected)), Severity.WARNING
    if not remedies:
        topics = dict.fromkeys(end.topic for _, end in unconnected)
        remedies.append(state("start-publisher", topics=topics))
        quiet = quiet_programs(evidence) if facts else []
        facts += [state("may-publish", process=one) for one in quiet]
        # what came often before has lost its publisher
        is_lost = any(end.messages >= connecting.FEWEST for _, end in unconnected)
        is_seldom = quiet or _waits_for_commands(evidence, unconnected)
        severity = Severity.NOTE if is_seldom and not is_lost else severity
    return finding("unconnected-subscriptions", facts, *remedies, severity=severity)


def _waits_for_commands(evidence: Evidence, unconnected: Iterable[connecting.End]) -> bool:
    """Return whether only simulators wait, and nobody publishes such commands to nobody."""
    simulators = simulator_ids(evidence)
    outputs = connecting.unconnected_ends(evidence.graph, Role.PUBLISHER, of_tools=True)
    given = {
        number for node, end in outputs if node.id not in simulators for number in end.fingerprints
    }
    return all(
        node.id in simulators and given.isdisjoint(end.fingerprints) for node, end in unconnected
    )


@rule(
    "unconnected-publications",
    remedy="start the node with OLD:=NEW, where a subscriber is missing",
    severity=Severity.NOTE,
    title="The following node publications have no announced subscriber:",
    facts=_NODE_TOPICS,
    remedies=REMAPS,
    evidence="announcements; sockets that listen without a node",
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
    suggestions = all_suggestions(evidence)
    known = {(suggestion.publisher, suggestion.channel) for suggestion in suggestions}
    apart = {suggestion.listener for suggestion in suggestions} | simulator_ids(evidence)
    awaited = {topic for process in evidence.processes for topic in process.awaited}
    unconnected = [
        (node, end)
        for node, end in connecting.unconnected_ends(evidence.graph, Role.PUBLISHER)
        if (node.id, end.topic) not in known
        if end.topic not in awaited | evidence.stale_subscribed
        if node.id not in apart
    ]
    remedies_for_publication = _connection_finder(evidence).remedies_for_publication
    remedies = (remedy for end in unconnected for remedy in remedies_for_publication(*end))
    yield from finding("unconnected-publications", _facts(unconnected), *remedies)


def quiet_programs(evidence: Evidence) -> list[LcmProcess]:
    """Return plain LCM programs on this bus that neither listen nor sent during the look."""
    known = {one.pid for one in evidence.listeners} | {one.pid for one in evidence.streams}
    return [one for one in evidence.plain_programs() if one.pid not in known]


def missed_topics(evidence: Evidence) -> set[str]:
    """Return the topics of subscriptions without a publisher."""
    return {end.topic for _, end in unconnected_subscriptions(evidence)}


@derived
def missed_on_other_buses(evidence: Evidence) -> set[str]:
    """Return the topics of subscriptions without a publisher that are published on another bus.

    Not those that a likely change connects to what is published on this one.
    """
    there = {topic for process in evidence.processes for topic in process.topics}
    missed = [one for one in unconnected_subscriptions(evidence) if one[1].topic in there]
    finder = _connection_finder(evidence)
    return {end.topic for node, end in missed if not finder.suggestions([(node, end)])}


@derived
def unconnected_subscriptions(evidence: Evidence) -> list[connecting.End]:
    """Return the subscriptions of live nodes without a publisher."""
    beside_plain = evidence.has_others() or bool(evidence.plain_programs())
    return connecting.unconnected_ends(evidence.graph, Role.SUBSCRIBER, beside_plain=beside_plain)


@derived
def all_suggestions(evidence: Evidence) -> list[connecting.Suggestion]:
    """Return the suggestions for all unconnected subscriptions, so that no rule repeats them."""
    return _connection_finder(evidence).suggestions(unconnected_subscriptions(evidence))


@derived
def _connection_finder(evidence: Evidence) -> connecting.ConnectionFinder:
    return connecting.ConnectionFinder(evidence.graph, channel_names(evidence))


def _facts(unconnected: Iterable[connecting.End]) -> Iterator[Statement]:
    for _, group in groupby(unconnected, key=lambda end: end[0].id):
        ends = list(group)
        yield state("node-topics", node=ends[0][0], topics=dict.fromkeys(e.topic for _, e in ends))


@rule(
    "names",
    remedy="use letters, digits, _ and /, at most 63 bytes, and the same everywhere",
    title={
        "long-names": "The following names are nearly as long as LCM can carry (63 bytes):",
        "similar-names": "The following channels look the same, but differ:",
        "unusable-names": "The following channels have names that few programs can subscribe to:",
    },
    facts={
        "channel": "{topic} from {sender}",
        "odd-channel": "{topic:repr} from {sender}: {reason}",
        "two-channels": "{topic:repr} from {sender}, and {other_topic:repr} from {other_sender}",
    },
    remedies={
        "plain-name": "use a name of letters, digits, _ and / only",
        "same-name": "publish both under the same name",
        "shorter-name": "use a shorter name",
        "subscribe-to-pattern": "or subscribe to the pattern {pattern}",
    },
    evidence="channels of all messages",
)
def names_are_good(evidence: Evidence) -> Iterator[Finding]:
    """Channels have names that every program can subscribe to, and no two names look the same.

    liblcm matches names as UTF-8 text: other names never arrive. A name has at most 63 bytes.
    """
    suggested = {one.channel for one in all_suggestions(evidence)}  # reported with a subscription
    senders = {s.channel: s.name for s in evidence.streams if s.channel not in suggested}
    bad = {channel: reason for channel in senders if (reason := _name_fault(channel))}
    odd = (state("odd-channel", topic=c, sender=senders[c], reason=why) for c, why in bad.items())
    patterns = [channel for channel, reason in bad.items() if reason == _IS_PATTERN]
    remedies = [state("subscribe-to-pattern", pattern=re.escape(c)) for c in patterns[:1]]
    yield from finding("unusable-names", odd, "plain-name", *remedies)
    long = [c for c in senders if len(c.encode("utf-8", "surrogateescape")) >= _LONG_NAME]
    note = Severity.NOTE
    facts = (state("channel", topic=channel, sender=senders[channel]) for channel in long)
    yield from finding("long-names", facts, "shorter-name", severity=note)
    alike: dict[str, list[str]] = defaultdict(list)
    for channel in sorted(senders):
        alike[channel.casefold().strip(" /")].append(channel)
    pairs = (pair for same in alike.values() for pair in combinations(same, 2))
    two = (
        state("two-channels", topic=a, sender=senders[a], other_topic=b, other_sender=senders[b])
        for a, b in pairs
    )
    yield from finding("similar-names", two, "same-name", severity=note)


def _name_fault(channel: str) -> str:
    """Return the reason why few programs can subscribe to a channel; "" if all can."""
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
    """Return whether a name, as a pattern of liblcm, matches itself."""
    if channel.startswith("#!"):  # LCM's own
        return True
    try:
        return re.fullmatch(channel, channel) is not None
    except re.error:
        return False
