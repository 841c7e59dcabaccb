"""Rules about connections: topics and services with both sides, and valid names."""

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator
from itertools import combinations, groupby

from lcmtools.doctor import connecting
from lcmtools.doctor.evidence import Evidence, LcmProcess, channel_names, derived
from lcmtools.doctor.findings import Finding, Severity, Statement, finding, rule, state, subject
from lcmtools.doctor.renaming import REMAPS, give_reason, near_names, remap_argument, start_with
from lcmtools.doctor.rules.shared import END_OR_REMAP, simulator_ids
from lcmtools.graph.model import NodeInfo, Role
from lcmtools.names import base_name_of, is_hidden

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
    unless={"other-buses": "topic", "stale-nodes": "published"},
    evidence="announcements, with command lines; channels of all messages",
)
def subscriptions_have_publishers(evidence: Evidence) -> Iterator[Finding]:
    """Every subscription has a publisher.

    One without is often in another namespace, has a slightly different name, or its publisher was
    not started. A note if it has not come repeatedly before, and a program that is not a node may
    publish it rarely, or only a simulator waits, and nothing that is published may be meant for it.
    """
    unconnected = unconnected_subscriptions(evidence)
    suggestions = all_suggestions(evidence)
    remedies = [one.remedy.of("topic", one.topic) for one in suggestions]
    title = state("unconnected-subscriptions").of("suggested", *(x.channel for x in suggestions))
    names = {node.id: node.name for node in evidence.graph.nodes}
    title = title.of("misled", *(names[one.listener] for one in suggestions))
    pairs = (f"{names[x.publisher]} {x.channel}" for x in suggestions if x.publisher)
    title = title.of("pair", *pairs)
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
    return finding(title, facts, *remedies, severity=severity)


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
    unless={
        "other-buses": "topic",
        "stale-nodes": "subscribed",
        "unconnected-subscriptions": "pair misled",
    },
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
    simulators = simulator_ids(evidence)
    ends = connecting.unconnected_ends(evidence.graph, Role.PUBLISHER)
    unconnected = [(node, end) for node, end in ends if node.id not in simulators]
    finder = _connection_finder(evidence)
    remedies = (
        one.of("pair", f"{node.name} {end.topic}").of("topic", end.topic).of("who", node.name)
        for node, end in unconnected
        for one in finder.remedies_for_publication(node, end)
    )
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
    unless={"unconnected-subscriptions": "suggested"},
    evidence="channels of all messages",
)
def names_are_good(evidence: Evidence) -> Iterator[Finding]:
    """Channels have names that every program can subscribe to, and no two names look the same.

    liblcm matches names as UTF-8 text: other names never arrive. A name has at most 63 bytes.
    """
    senders = {s.channel: s.name for s in evidence.streams}
    bad = {channel: reason for channel in senders if (reason := _name_fault(channel))}
    odd = (state("odd-channel", topic=c, sender=senders[c], reason=why) for c, why in bad.items())
    patterns = [channel for channel, reason in bad.items() if reason == _IS_PATTERN]
    remedies = [
        state("subscribe-to-pattern", pattern=re.escape(c)).of("topic", c) for c in patterns[:1]
    ]
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
    if channel.startswith("#!") or channel.replace("/", "").replace("_", "").isalnum():
        return True
    try:
        return re.fullmatch(channel, channel) is not None
    except re.error:
        return False


@rule(
    "services",
    remedy="start one of them with OLD:=NEW, or the node that offers what is called",
    title={
        "services": "The following services are offered by more than one node, and each executes a"
        " request:",
        "unconnected-clients": "The following call services that no node offers:",
    },
    facts={"calls": "{node} calls {service}", "offered": "{service}: {nodes:and}"},
    remedies={
        **REMAPS,
        **END_OR_REMAP,
        "start-server": "start a node that offers {service}; to see what is offered:"
        " `lcmtools service list`",
    },
    evidence="announcements",
)
def services_are_offered_once(evidence: Evidence) -> Iterator[Finding]:
    """Services that nodes call are offered, and by one node each.

    Where two offer one, each executes a request, and the first response is used. Two nodes of one
    name, and nodes that were killed or hang, are reported by other rules.
    """
    offered: dict[str, dict[str, NodeInfo]] = defaultdict(dict)  # by service and node
    for node in evidence.graph.nodes:
        for end in node.having(Role.SERVICE):
            if not is_hidden(end.topic):
                offered[end.topic][node.name] = node
    facts, remedies = [], []
    for name, nodes in sorted(offered.items()):
        if len(live := [node for node in nodes.values() if not node.stale]) > 1:
            facts.append(state("offered", service=name, nodes=map(subject, live)))
            remedies.append(_separation(evidence, name, live))
    yield from finding("services", facts, *remedies)
    if any(x.stale and not x.is_hidden for x in evidence.graph.nodes):  # it may offer the service
        return
    callers = [node for node in evidence.graph.nodes if not node.tool]
    calls = [(node, end.topic) for node in callers for end in node.having(Role.CLIENT)]
    calling = [(n, name) for n, name in calls if not (is_hidden(name) or name in offered)]
    facts = [state("calls", node=node, service=name) for node, name in calling]
    remedies = [_connection_remedy(node, name, list(offered)) for node, name in calling]
    yield from finding("unconnected-clients", facts, *remedies)


def _separation(evidence: Evidence, service: str, nodes: list[NodeInfo]) -> Statement:
    pids = tuple(str(node.pid) for node in nodes if node.id not in evidence.remote)
    old = remap_argument(nodes[-1], service).partition(":=")[0] or service
    known = {"pids": pids if len(pids) > 1 else (), "old": old, "new": f"{service}_2"}
    return state("end-one-or-remap", other=nodes[-1], **known)


def _connection_remedy(node: NodeInfo, service: str, offered: list[str]) -> Statement:
    """Return a remap to a service of a similar name, or of the same name in another namespace."""
    meant = [one for one in offered if base_name_of(one) == base_name_of(service)]
    for other in (*meant, *near_names(service, offered)):
        return give_reason(start_with(node, service, other), "offered", channel=other)
    return state("start-server", service=service)
