"""Rules about relays, by their own reports."""

from collections.abc import Iterator

from lcmtools.doctor.evidence import Evidence, RelayEnd
from lcmtools.doctor.findings import Finding, Severity, Subject, found, rule, state
from lcmtools.graph.model import Role


@rule("relay-bus", "start what the relay joins, or see whether the line to it works")
def relays_reach_their_buses(evidence: Evidence) -> Iterator[Finding]:
    """Every relay reaches both of its buses.

    One that does not tries again until it does; messages for the bus are dropped meanwhile.
    """
    facts = (
        state("relay-bus", **_who(end), trouble=end.trouble) for end in _with(evidence, "trouble")
    )
    return found("relay-bus", facts, "mend-line")


@rule("relay-losses", "let the relay carry less: --rate '/camera/**=5', --newest, --deny")
def relays_drop_nothing(evidence: Evidence) -> Iterator[Finding]:
    """No relay drops messages.

    It does where a line takes less than comes for it: what has waited for a second is not sent.
    """
    facts = (
        state("relay-dropped", **_who(end), bus=end.bus, count=end.dropped)
        for end in _with(evidence, "dropped")
    )
    return found("relay-losses", facts, "carry-less")


@rule("relay-commands", "start the relay with --allow TOPIC")
def commands_may_pass(evidence: Evidence) -> Iterator[Finding]:
    """Commands to actuators pass a relay if a node on the other bus waits for them.

    They do only where --allow has their very name, so that nobody drives a robot by accident. A
    note, for it may be meant so: --deny says that it is.
    """
    sent = {one.channel for one in evidence.streams}
    sent |= {end.topic for node in evidence.graph.nodes for end in node.having(Role.PUBLISHER)}
    pairs = [(end, topic) for end in _with(evidence, "commands") for topic in end.commands]
    pairs = [(end, topic) for end, topic in pairs if topic in sent]
    facts = (state("relay-command", **_who(end), topic=topic) for end, topic in pairs)
    remedies = (state("allow-command", relay=_who(end)["relay"], topic=t) for end, t in pairs)
    return found("relay-commands", facts, *remedies, severity=Severity.NOTE)


@rule("relay-standby", "end it, if it is not to take over", Severity.NOTE)
def relays_carry_messages(evidence: Evidence) -> Iterator[Finding]:
    """Every relay carries messages, unless it is to take over from another one.

    Of several relays that join the same buses one carries, by its own rules alone.
    """
    names = {end.relay: end for end in evidence.relays if end.stands_by and not end.trouble}
    facts = (state("relay-standby", **_who(end)) for end in names.values())
    remedies = (state("end-standby", relay=_who(end)["relay"]) for end in names.values())
    return found("relay-standby", facts, *remedies)


def _with(evidence: Evidence, field: str) -> list[RelayEnd]:
    return [end for end in evidence.relays if getattr(end, field)]


def _who(end: RelayEnd) -> dict[str, Subject]:
    return {"relay": Subject("node", end.relay), "host": Subject("host", end.host)}
