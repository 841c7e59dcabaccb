"""Rules about message types."""

from collections.abc import Iterator, Mapping

from lcmtools.doctor.model import Evidence, Finding, Severity, rule
from lcmtools.doctor.near_types import kinship
from lcmtools.graph.model import Endpoint, Node, Topic, Traffic
from lcmtools.messages.registry import candidates
from lcmtools.names import is_hidden
from lcmtools.wire.packet import Sender

_RENEW = "generate the code of both sides from the same .lcm files: lcm-gen"
_NO_TYPE = -1  # in place of a fingerprint, where there is none or it changes with each message


@rule("type-mismatch", Severity.ERROR, "remap one of them to another topic: OLD:=NEW")
def topics_have_one_type(evidence: Evidence) -> Iterator[Finding]:
    """Everybody means the same type by a topic, and what is sent is of that type.

    A subscriber cannot read messages of another type, and drops them. Types of equal fields are the
    same on the wire: those are a note.
    """
    graph, names = evidence.graph, _names(evidence)
    for name in graph.topic_names():
        topic = graph.topic(name)
        rows = [*_announced(topic), *_seen(topic, names)]
        if not disagree(topic) and not is_hidden(name) and _differ_in_name(topic):
            yield Finding(
                "type-mismatch",
                Severity.NOTE,
                f"The types on {name} have the same fields, but different names:",
                tuple(rows),
                ("it works; say the same type on both sides, so that everybody shows the same",),
            )
        if disagree(topic):
            yield Finding(
                "type-mismatch",
                Severity.ERROR,
                f"The types on {name} do not match:",
                tuple(rows),
                (
                    *_renewal(topic),
                    f"remap one of them to another topic, for example {name}:={name}_2",
                ),
            )


@rule("unknown-type", Severity.NOTE, "generate the sender's types anew from the same .lcm files")
def types_are_known(evidence: Evidence) -> Iterator[Finding]:
    """No type is nearly a known one, and not it.

    It is often an older or newer version of it. Which field differs is found by the fingerprint;
    other unknown types are nobody's fault.
    """
    rows, names = [], _names(evidence)
    for name in evidence.graph.topic_names():
        topic = evidence.graph.topic(name)
        unknown = {f for seen in topic.foreign for f in seen.fingerprints if not candidates(f)}
        # several fingerprints are those of data that is no LCM message
        if is_hidden(name) or disagree(topic) or len(unknown) != 1:
            continue
        who = " and ".join(names.get(seen.sender, str(seen.sender)) for seen in topic.foreign)
        rows += [f" * {name} from {who}: {_describe(n, ())}" for n in unknown if kinship(n)]
    if rows:
        yield Finding(
            "unknown-type",
            Severity.NOTE,
            "The types of the following are nearly known ones:",
            tuple(rows),
            (_RENEW,),
        )


def disagree(topic: Topic) -> bool:
    """Whether something is sent that a subscriber, or another publisher, takes for another type."""
    sent = [set(endpoint.fingerprints) for _, endpoint in topic.publishers if endpoint.fingerprints]
    sent += [{fingerprint} for seen in topic.traffic for fingerprint in _sent_by(seen)]
    taken = [set(e.fingerprints) for _, e in topic.subscribers if e.fingerprints]
    return any(not one & other for one in sent for other in taken) or (
        # without a subscriber that takes both, two publishers of different types are at odds
        not taken and len({frozenset(one) for one in sent}) > 1
    )


def _renewal(topic: Topic) -> list[str]:
    """What helps where a type is sent that nobody knows."""
    sent = {number for seen in topic.foreign for number in _sent_by(seen)} - {_NO_TYPE}
    return [_RENEW] if any(not candidates(number) for number in sent) else []


def _announced(topic: Topic) -> Iterator[str]:
    for node, endpoint in topic.publishers:
        yield _row(node, "publishes", endpoint)
    for node, endpoint in topic.subscribers:
        if endpoint.fingerprints:
            yield _row(node, "expects", endpoint)


def _row(node: Node, verb: str, endpoint: Endpoint) -> str:
    return f" * {node.name} {verb} {' or '.join(endpoint.types)}"


def _seen(topic: Topic, names: Mapping[Sender | None, str]) -> Iterator[str]:
    for traffic in topic.foreign:
        for fingerprint in _sent_by(traffic):
            who = names.get(traffic.sender, str(traffic.sender))
            yield f" * {who} sends {_describe(fingerprint, topic.types)}"


def _names(evidence: Evidence) -> dict[Sender | None, str]:
    """The senders for people."""
    return {one.sender: one.name for one in evidence.senders}


def _differ_in_name(topic: Topic) -> bool:
    """Whether what is published is called otherwise by every subscriber."""
    taken = [set(endpoint.types) for _, endpoint in topic.subscribers if endpoint.fingerprints]
    sent = {endpoint.type for _, endpoint in topic.publishers if endpoint.fingerprints}
    return any(not sent & types for types in taken) if sent else False


def _sent_by(traffic: Traffic) -> list[int]:
    """The types that a sender means: all known ones, or its one unknown one, or none at all."""
    known = [fingerprint for fingerprint in traffic.fingerprints if candidates(fingerprint)]
    return known or (list(traffic.fingerprints) if len(traffic.fingerprints) == 1 else [_NO_TYPE])


def _describe(fingerprint: int, expected: tuple[str, ...]) -> str:
    if fingerprint == _NO_TYPE:
        return "data that is no LCM message"
    known = " or ".join(candidates(fingerprint))
    if known:
        return known
    near = kinship(fingerprint, expected)
    return f"an unknown type ({fingerprint:#018x}{f': {near}' if near else ''})"
