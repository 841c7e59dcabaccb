"""The rules, one file for each family. A new rule is a function with ``@rule``."""

from collections.abc import Iterable
from dataclasses import replace

from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import Finding, Rule
from lcmtools.doctor.rules import (
    bus,
    callbacks,
    connections,
    content,
    frames,
    listeners,
    network,
    nodes,
    pace,
    relays,
    reports,
    services,
    traffic,
    types,
)

_FAMILIES = (
    *(bus, network, relays, nodes, reports, callbacks, types, connections, services, pace),
    *(traffic, listeners, content, frames),
)
RULES = tuple(one for family in _FAMILIES for one in vars(family).values() if type(one) is Rule)

_EXPLAINED_BY = {
    "no-traffic": {"other-buses", "silent", "stuck-listeners", "loss", "malformed"},
    "relay-losses": {"relay-bus"},
}


def examine(evidence: Evidence, rules: Iterable[Rule] = RULES) -> list[Finding]:
    """Return the findings of rules, the most severe first, without those that another explains."""
    chosen = tuple(rules)
    evidence = _without_other_rules(evidence, chosen)
    findings = [finding for rule in chosen for finding in rule.examine(evidence)]
    found = {finding.rule for finding in findings}
    findings = [f for f in findings if found.isdisjoint(_EXPLAINED_BY.get(f.rule, ()))]
    return sorted(findings, key=lambda finding: -finding.severity)


def _without_other_rules(evidence: Evidence, chosen: tuple[Rule, ...]) -> Evidence:
    """Return the evidence without what a rule would leave to another one that is not chosen."""
    if bus.programs_are_on_this_bus not in chosen:
        alone = [replace(process, topics=(), awaited=()) for process in evidence.processes]
        evidence = replace(evidence, processes=alone)
    if nodes.nodes_answer not in chosen:
        none: frozenset[str] = frozenset()
        evidence = replace(evidence, stale_published=none, stale_subscribed=none)
    return evidence
