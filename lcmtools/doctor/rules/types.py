"""Rules about message types."""

from collections.abc import Iterator, Mapping

from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import (
    Finding,
    Part,
    Severity,
    Statement,
    Subject,
    cases,
    finding,
    rule,
    state,
)
from lcmtools.doctor.near_types import nearest_type
from lcmtools.graph.model import Topic, Traffic
from lcmtools.messages.registry import candidates
from lcmtools.names import is_hidden
from lcmtools.wire.packet import Sender

_NO_TYPE = -1  # in place of a fingerprint, where there is none or it changes with each message


@rule("type-mismatch", "remap one of them to another topic: OLD:=NEW", Severity.ERROR)
def topics_have_one_type(evidence: Evidence) -> Iterator[Finding]:
    """All publishers and subscribers of a topic use the same type.

    A subscriber cannot read messages of another type, and drops them. Types of equal fields are the
    same on the wire: those are a note.
    """
    graph, names = evidence.graph, _names(evidence)
    for name in graph.topic_names():
        topic = graph.topic(name)
        facts = (*_announced(topic), *_seen(topic, names))
        if disagree(topic):
            title, remap = (state(kind, topic=name) for kind in ("type-mismatch", "remap-one"))
            yield finding(title, facts, *_renewal(topic), remap, severity=Severity.ERROR)
        elif not is_hidden(name) and _differ_in_name(topic):
            title = state("type-names-differ", topic=name)
            yield finding(title, facts, "same-type", severity=Severity.NOTE)


@rule(
    "unknown-type",
    "generate the sender's types again from the same .lcm files",
    Severity.NOTE,
)
def types_are_known(evidence: Evidence) -> Iterator[Finding]:
    """No unknown type is nearly a known one.

    It is often an older or newer version of it. Its fingerprint shows which field differs; other
    unknown types are not reported.
    """
    facts, names = [], _names(evidence)
    for name in evidence.graph.topic_names():
        topic = evidence.graph.topic(name)
        unknown = {f for seen in topic.foreign for f in seen.fingerprints if not candidates(f)}
        # several fingerprints are those of data that is no LCM message
        if is_hidden(name) or disagree(topic) or len(unknown) != 1:
            continue
        (number,) = unknown
        senders = tuple(_sender(seen, names) for seen in topic.foreign)
        if nearest_type(number):
            facts.append(state("unknown-type", topic=name, senders=senders, **_type(number, ())))
    return cases("unknown-type", facts, "same-lcm-files", severity=Severity.NOTE)


def disagree(topic: Topic) -> bool:
    """Return whether a message is sent that a subscriber, or other publisher, cannot decode."""
    sent = [set(endpoint.fingerprints) for _, endpoint in topic.publishers if endpoint.fingerprints]
    sent += [{fingerprint} for seen in topic.traffic for fingerprint in _sent_by(seen)]
    taken = [set(e.fingerprints) for _, e in topic.subscribers if e.fingerprints]
    return any(not one & other for one in sent for other in taken) or (
        # without a subscriber that takes both, two publishers of different types are at odds
        not taken and len({frozenset(one) for one in sent}) > 1
    )


def _renewal(topic: Topic) -> list[str]:
    """The remedy if an unknown type is sent."""
    sent = {number for seen in topic.foreign for number in _sent_by(seen)} - {_NO_TYPE}
    return ["same-lcm-files"] if any(not candidates(number) for number in sent) else []


def _announced(topic: Topic) -> Iterator[Statement]:
    for node, endpoint in topic.publishers:
        yield state("publishes", node=node, types=endpoint.types)
    for node, endpoint in topic.subscribers:
        if endpoint.fingerprints:
            yield state("expects", node=node, types=endpoint.types)


def _seen(topic: Topic, names: Mapping[Sender | None, str]) -> Iterator[Statement]:
    for seen in topic.foreign:
        for number in _sent_by(seen):
            yield state("sends", sender=_sender(seen, names), **_type(number, topic.types))


def _sender(seen: Traffic, names: Mapping[Sender | None, str]) -> Subject:
    name = names.get(seen.sender, str(seen.sender))
    return Subject("sender", name, address=str(seen.sender or ""))


def _names(evidence: Evidence) -> dict[Sender | None, str]:
    """The senders for people."""
    return {one.sender: one.name for one in evidence.senders}


def _differ_in_name(topic: Topic) -> bool:
    """Return whether every subscriber calls the published types by other names."""
    taken = [set(endpoint.types) for _, endpoint in topic.subscribers if endpoint.fingerprints]
    sent = {endpoint.type for _, endpoint in topic.publishers if endpoint.fingerprints}
    return any(not sent & types for types in taken) if sent else False


def _sent_by(traffic: Traffic) -> list[int]:
    """The types that a sender means: all known ones, or its one unknown one, or none at all."""
    known = [fingerprint for fingerprint in traffic.fingerprints if candidates(fingerprint)]
    return known or (list(traffic.fingerprints) if len(traffic.fingerprints) == 1 else [_NO_TYPE])


def _type(fingerprint: int, expected: tuple[str, ...]) -> dict[str, Part]:
    """The parts of a statement that describe a type."""
    if fingerprint == _NO_TYPE:
        return {}
    if known := candidates(fingerprint):
        return {"types": tuple(known)}
    near = nearest_type(fingerprint, expected)
    hexadecimal: dict[str, Part] = {"fingerprint": f"{fingerprint:#018x}"}
    return hexadecimal | ({"like": near.name, "difference": near.difference} if near else {})
