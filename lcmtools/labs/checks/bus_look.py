"""The program under check as seen on the check's bus, and the findings of wtf about it.

Only findings about this program help its author, with remedies that change the program. Commands
are left out: in another terminal, they would use another bus.
"""

import os
import re
from collections.abc import Collection, Iterable, Iterator
from dataclasses import replace

from lcmtools.bus.url import parse_url
from lcmtools.doctor.collect import collect
from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import Finding, Severity, Statement
from lcmtools.doctor.rules import examine
from lcmtools.doctor.sentences import describe
from lcmtools.graph.common_topics import OF_EVERY_NODE
from lcmtools.graph.model import Endpoint, NodeInfo, Role, Topic
from lcmtools.labs.checks.observations import BusLook, Failure, Wire

_LISTEN = 1.0  # [s]
_OF_PACE = ("queue-drops", "kernel-drops", "slow-callbacks", "irregular", "slow-rate", "loss")
"""Rules that judge a pace: here the simulator is faster than real time."""
_TOLD = ("callback-errors", "logged")
"""Rules whose findings a row's cause, or the program's own words, tell already."""
_ELSEWHERE = ("remap-one", "rename-one")
"""Remedies at either end of a wire: the names of the topics are the lab's."""
_OBSERVER = re.compile(r"/_lcmtools_lab_\d+")


def look_at_bus(url: str, group: int) -> BusLook:
    """Observe the programs of one process group on a bus for a second."""
    return program_on(collect(parse_url(url), os.environ, _LISTEN), group)


def program_on(evidence: Evidence, group: int) -> BusLook:
    """Return the state of the programs of one process group according to evidence."""
    nodes = [node for node in evidence.own_nodes() if _is_of(node.pid, group)]
    names = {node.name for node in nodes}
    ends = [end for node in nodes for end in node.endpoints]
    publications = [_wire(end) for end in ends if end.role is Role.PUBLISHER]
    announced = {wire.topic for wire in publications}
    publications += [
        Wire(stream.channel, messages=len(stream.times))
        for stream in evidence.streams
        if stream.pid and _is_of(stream.pid, group) and stream.channel not in announced
    ]
    return BusLook(
        nodes=sorted(names),
        publications=[wire for wire in publications if not _is_own_affair(wire.topic)],
        subscriptions=[
            _wire(end, _offered(end, evidence.graph.topic(end.topic), names))
            for end in ends
            if end.role is Role.SUBSCRIBER and not _is_own_affair(end.topic)
        ],
        runs_callbacks=any(node.busy > 0 for node in nodes) or any(end.calls for end in ends),
        failures=[
            Failure(error.exception, error.message, error.place, error.count, error.callback)
            for node in nodes
            for error in node.errors
        ],
        findings=list(_texts(examine(evidence), nodes, group)),
    )


def _is_of(pid: int, group: int) -> bool:
    try:
        return os.getpgid(pid) == group
    except OSError:  # it has ended
        return False


def _is_own_affair(topic: str) -> bool:
    """Return True for endpoints that every node has."""
    return topic in OF_EVERY_NODE or "/_" in topic


def _wire(end: Endpoint, offered: str = "") -> Wire:
    times = end.longest / 1e9, end.busy / 1e9
    return Wire(end.topic, end.type, end.messages, end.calls, *times, offered)


def _offered(end: Endpoint, topic: Topic, names: Collection[str]) -> str:
    """Return the type that other nodes publish if the subscription cannot decode it."""
    others = (endpoint for node, endpoint in topic.publishers if node.name not in names)
    odd = (
        endpoint.type for endpoint in others if not {*endpoint.fingerprints} & {*end.fingerprints}
    )
    return next(odd, "")


def _texts(findings: Iterable[Finding], nodes: Iterable[NodeInfo], group: int) -> Iterator[str]:
    """Format the findings about these nodes, each with its remedies in one line."""
    names = {node.name for node in nodes}

    def is_about(statement: Statement) -> bool:
        return any(
            subject.name in names or (subject.pid is not None and _is_of(subject.pid, group))
            for subject in statement.subjects()
        )

    def is_at_this_end(remedy: Statement) -> bool:
        others = {
            subject.name for subject in remedy.subjects() if subject.kind in ("node", "process")
        }
        return others <= names and remedy.kind not in _ELSEWHERE

    for finding in findings:
        facts = tuple(fact for fact in finding.facts if is_about(fact))
        if (
            finding.severity is Severity.NOTE
            or finding.rule in (*_OF_PACE, *_TOLD)
            or not (facts or is_about(finding.title))
        ):
            continue
        remedies = tuple(filter(is_at_this_end, finding.remedies))
        words = describe(replace(finding, facts=facts, remedies=remedies))
        items = ", ".join(item.strip(" *") for item in words.items).replace(":,", ":")
        wanted = [text for text in words.remedies if "lcmtools " not in text]
        line = " -> ".join((f"{words.title} {items}".strip(), *wanted))
        yield _OBSERVER.sub("this check", line)
