"""Rules about relays and full lines, by the reports of relays, servers and nodes."""

import shlex
from collections.abc import Iterator

from lcmtools.doctor.evidence import Evidence, RelayEnd
from lcmtools.doctor.findings import (
    Finding,
    Severity,
    Statement,
    Subject,
    finding,
    rule,
    state,
    subject,
)
from lcmtools.graph.model import FullLine, Graph, NodeInfo, Role

_SHARE = 0.8  # of the messages that a line takes


@rule(
    "relay-bus",
    remedy="start the bus that the relay joins, or check the connection to it",
    title="The following relays do not reach one of their buses:",
    facts={"relay-bus": "{relay} on {host}: {trouble}"},
    remedies={
        "mend-line": "start the bus that the relay joins, or repair the connection; the relay"
        " retries",
    },
    evidence="the reports of relays",
)
def relays_reach_their_buses(evidence: Evidence) -> Iterator[Finding]:
    """Every relay reaches both of its buses.

    A relay that does not retries until it does; messages for the bus are dropped meanwhile.
    """
    ends = [end for end in evidence.relays if end.trouble]
    facts = (state("relay-bus", **_relay_and_host(end), trouble=end.trouble) for end in ends)
    return finding("relay-bus", facts, "mend-line")


@rule(
    "relay-losses",
    remedy="let the relay carry less: --rate '/camera/**=5', --newest, --deny",
    title="The following relays drop messages, because a line is full:",
    facts={"relay-dropped": "{relay} on {host}: {count:messages} for {bus}"},
    remedies={
        "limit-rates": "start {relay} again with `{options}` as well",
        "limit-sender": "let less be sent by {relay}, for example by the relay that brings it:"
        " `{options}`",
        "carry-less": "let it carry less, for example of images: --rate '/camera/**=5' --newest"
        " '/camera/**', or --deny",
    },
    unless={"relay-bus": ""},
    evidence="two reports of each relay, and announcements of relays and servers",
)
def relays_drop_nothing(evidence: Evidence) -> Iterator[Finding]:
    """No relay drops messages.

    A relay drops messages if a line is slower than the messages for it: a message that has waited
    for a second is not sent.
    """
    relays = {end.id for end in evidence.relays}
    ends = [end for end in evidence.relays if end.dropped]
    facts = [state("relay-dropped", **_relay_and_host(x), bus=x.bus, count=x.dropped) for x in ends]
    full = {(end.id, end.bus) for end in ends}
    remedies: list[str | Statement] = [
        _remedy("limit-rates", node, line)
        for node, line in _full_lines(evidence.graph)
        if (node.id, line.to) in full
    ]
    for node, line, count in _dropping(evidence):
        if node.id not in relays and not _published(node, line):  # a server
            place = {"relay": subject(node), "host": Subject("host", node.host)}
            facts.append(state("relay-dropped", **place, bus=line.to, count=count))
            remedies.append(_remedy("limit-sender", node, line))
    return finding("relay-losses", facts, *(remedies or ["carry-less"]))


@rule(
    "full-line",
    remedy="publish less often, or smaller messages",
    title="The following nodes drop messages, because a line is full:",
    facts={
        "full-line": "{node} on {host}: {topic}, {rate:.3g} Hz, of which {passing:.3g} Hz pass to"
        " {line}",
        "full-line-of": "{node} on {host}: {topic}, of which {passing:.3g} Hz pass to {line}",
    },
    remedies={
        "publish-less": "let {node} publish {topic} at {limit:g} Hz at most, or smaller messages",
        "publish-smaller": "let {node} publish smaller messages on {topic}, or none",
    },
    evidence="two announcements of each node (on Zenoh)",
)
def lines_take_what_nodes_publish(evidence: Evidence) -> Iterator[Finding]:
    """Lines to other computers take all that nodes publish.

    On Zenoh, small messages go first on a full line, and of large ones the newest; a node announces
    what it drops. Every program on the other computer that receives a topic, such as wtf itself,
    takes a part of the line.
    """
    facts, remedies = [], []
    for node, line, _ in _dropping(evidence):
        rates = _published(node, line)
        for topic, passing in line.passing:
            rate = rates.get(topic, 0.0)
            if topic not in rates or 0 < _SHARE * rate < passing:  # it only waited with another one
                continue
            place = {"node": subject(node), "topic": Subject("topic", topic)}
            kind, host = "full-line" if rate else "full-line-of", Subject("host", node.host)
            known = {"rate": rate, "passing": passing}
            facts.append(state(kind, **place, **known, host=host, line=line.to))
            limit = _limit_of(passing)
            kind = "publish-less" if limit else "publish-smaller"
            remedies.append(state(kind, **place, limit=limit))
    return finding("full-line", facts, *remedies)


def is_in_doubt(evidence: Evidence) -> bool:
    """Return whether a line is full: two reports of its relay tell what was dropped."""
    return bool(_full_lines(evidence.graph))


def _full_lines(graph: Graph) -> list[tuple[NodeInfo, FullLine]]:
    live = (node for node in graph.nodes if not node.stale)
    return [(node, line) for node in live for line in node.full_lines if line.passing]


def _dropping(evidence: Evidence) -> Iterator[tuple[NodeInfo, FullLine, int]]:
    """Yield the lines for which messages were dropped during the look, and how many."""
    known = {node.id for node in evidence.before.nodes}  # others: a full line delays answers, too
    before = {_key(*one): one[1].dropped for one in _full_lines(evidence.before)}
    for node, line in _full_lines(evidence.graph):
        first = before.get(_key(node, line), line.dropped if node.id in known else 0)
        count = line.dropped - first
        if count > 0:
            yield node, line, count


def _key(node: NodeInfo, line: FullLine) -> tuple[str, str]:
    """Return what counts the messages: each line of a relay, but all lines of a publisher."""
    return node.id, "" if _published(node, line) else line.to


def _published(node: NodeInfo, line: FullLine) -> dict[str, float]:
    """Return the rates of the topics of a line that the node publishes itself; 0 if unknown."""
    named = dict(line.passing)
    return {end.topic: end.rate for end in node.having(Role.PUBLISHER) if end.topic in named}


def _remedy(kind: str, node: NodeInfo, line: FullLine) -> Statement:
    options = " ".join(_limit(topic, rate) for topic, rate in line.passing)
    return state(kind, relay=subject(node), options=options)


@rule(
    "relay-commands",
    remedy="start the relay with --allow TOPIC",
    title="Commands do not pass a relay, and a node behind it waits for them:",
    facts={"relay-command": "{topic}, at {relay} on {host}"},
    remedies={
        "allow-command": "if they should pass: start {relay} with --allow {topic} (and --allow"
        " '**', if it has no other); else with --deny {topic}",
    },
    evidence="the reports of relays, announcements and all messages of the look",
)
def commands_may_pass(evidence: Evidence) -> Iterator[Finding]:
    """Commands to actuators pass a relay if a node on the other bus waits for them.

    They pass only if --allow gives their exact name, so that nobody drives a robot by accident. A
    note, because it may be intended; --deny confirms that.
    """
    sent = {one.channel for one in evidence.streams}
    sent |= {end.topic for node in evidence.graph.nodes for end in node.having(Role.PUBLISHER)}
    pairs = [(end, topic) for end in evidence.relays for topic in end.commands if topic in sent]
    facts = (state("relay-command", **_relay_and_host(end), topic=topic) for end, topic in pairs)
    relays = ((Subject("node", end.relay), topic) for end, topic in pairs)
    remedies = (state("allow-command", relay=relay, topic=topic) for relay, topic in relays)
    return finding("relay-commands", facts, *remedies, severity=Severity.NOTE)


@rule(
    "relay-standby",
    remedy="end it, if it should not take over",
    severity=Severity.NOTE,
    title="The following relays stand by, because others join the same buses:",
    facts={"relay-standby": "{relay} on {host}"},
    remedies={
        "end-standby": "if it should not take over from the other one: `lcmtools node kill {relay}`"
    },
    evidence="the reports of relays",
)
def relays_carry_messages(evidence: Evidence) -> Iterator[Finding]:
    """Every relay carries messages, unless it should take over from another one.

    If several relays join the same buses, one carries messages, and only its rules apply.
    """
    names = {end.relay: end for end in evidence.relays if end.stands_by and not end.trouble}
    facts = (state("relay-standby", **_relay_and_host(end)) for end in names.values())
    remedies = (state("end-standby", relay=Subject("node", name)) for name in names)
    return finding("relay-standby", facts, *remedies)


def _limit(topic: str, passing: float) -> str:
    """Return the option of a relay by which a line takes all messages of a topic."""
    rate = _limit_of(passing)
    return shlex.join(["--rate", f"{topic}={rate:g}"] if rate else ["--deny", topic])


def _limit_of(passing: float) -> float:
    return float(f"{_SHARE * passing:.2g}")


def _relay_and_host(end: RelayEnd) -> dict[str, Subject]:
    return {"relay": Subject("node", end.relay), "host": Subject("host", end.host)}
