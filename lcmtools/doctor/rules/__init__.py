"""The rules, one file for each family. A new rule is a function with ``@rule``."""

from collections.abc import Iterable

from lcmtools.doctor.arbiter import arbitrate
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


def examine(evidence: Evidence, rules: Iterable[Rule] = RULES) -> list[Finding]:
    """Return the findings of rules, the most severe first, without those that another explains."""
    chosen = set(rules)
    found = {rule: rule.examine(evidence) for rule in RULES if rule in chosen}
    remote = (node.name for node in evidence.graph.nodes if node.id in evidence.remote)
    return sorted(arbitrate(found, remote), key=lambda finding: -finding.severity)
