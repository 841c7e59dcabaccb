"""Rules about relays, by their own reports."""

from collections.abc import Iterator

from lcmtools.doctor.evidence import Evidence, RelayEnd
from lcmtools.doctor.findings import Finding, Severity, Subject, finding, rule, state
from lcmtools.graph.model import Role


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
    title="The following relays drop messages:",
    facts={"relay-dropped": "{relay} on {host}: {count} messages for {bus}"},
    remedies={
        "carry-less": "let it carry less, for example of images: --rate '/camera/**=5' --newest"
        " '/camera/**', or --deny",
    },
    evidence="two reports of each relay",
)
def relays_drop_nothing(evidence: Evidence) -> Iterator[Finding]:
    """No relay drops messages.

    A relay drops messages if a line is slower than the messages for it: a message that has waited
    for a second is not sent.
    """
    ends = [end for end in evidence.relays if end.dropped]
    facts = (state("relay-dropped", **_relay_and_host(x), bus=x.bus, count=x.dropped) for x in ends)
    return finding("relay-losses", facts, "carry-less")


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


def _relay_and_host(end: RelayEnd) -> dict[str, Subject]:
    return {"relay": Subject("node", end.relay), "host": Subject("host", end.host)}
