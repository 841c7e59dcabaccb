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
    "incomplete-messages": {"loss"},
    "no-traffic": {"other-buses", "silent", "stuck-listeners", "loss", "malformed"},
    "relay-losses": {"relay-bus"},
}
_COVERED_BY = {"kernel-drops": "small-buffer"}
"""Rules whose findings another one's remedy mends too, for the listeners that it names."""


def examine(evidence: Evidence, rules: Iterable[Rule] = RULES) -> list[Finding]:
    """Return the findings of rules, the most severe first, without those that another explains."""
    chosen = tuple(rules)
    evidence = _without_other_rules(evidence, chosen)
    findings = [finding for rule in chosen for finding in rule.examine(evidence)]
    found = {finding.rule for finding in findings}
    findings = [f for f in findings if found.isdisjoint(_EXPLAINED_BY.get(f.rule, ()))]
    findings = [f for f in findings if not _is_covered(f, findings)]
    return sorted(findings, key=lambda finding: -finding.severity)


def _is_covered(finding: Finding, others: Iterable[Finding]) -> bool:
    """Return whether another finding has all subjects of this one, and its remedy mends both."""
    covering = (one for one in others if one.rule == _COVERED_BY.get(finding.rule))
    return any(set(finding.subjects()) <= set(one.subjects()) for one in covering)


def _without_other_rules(evidence: Evidence, chosen: tuple[Rule, ...]) -> Evidence:
    """Return the evidence without what a rule would leave to another one that is not chosen."""
    if bus.programs_are_on_this_bus not in chosen:
        alone = [replace(process, topics=(), awaited=()) for process in evidence.processes]
        evidence = replace(evidence, processes=alone)
    if nodes.nodes_answer not in chosen:
        none: frozenset[str] = frozenset()
        evidence = replace(evidence, stale_published=none, stale_subscribed=none)
    return evidence
