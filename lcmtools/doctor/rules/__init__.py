"""The rules, one file for each family. A new rule is a function with ``@rule``.

Collecting evidence judges nothing: it is handed ``in_doubt`` or ``shows_signs``, looks on for some
more seconds if that returns True, and all rules judge once at the end. No rule speaks of durations.
"""

from collections.abc import Iterable

from lcmtools.doctor.arbiter import arbitrate
from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import Finding, Rule, Severity
from lcmtools.doctor.rules import (
    bus,
    callbacks,
    connections,
    content,
    listeners,
    network,
    nodes,
    pace,
    relays,
    traffic,
    types,
)
from lcmtools.doctor.rules.bus import is_empty

_FAMILIES = (
    *(bus, network, relays, nodes, callbacks, types, connections, pace),
    *(traffic, listeners, content),
)
RULES = tuple(one for family in _FAMILIES for one in vars(family).values() if type(one) is Rule)


def examine(evidence: Evidence, rules: Iterable[Rule] = RULES) -> list[Finding]:
    """Return the findings of rules, the most severe first, without those that another explains."""
    chosen = set(rules)
    found = {rule: rule.examine(evidence) for rule in RULES if rule in chosen}
    remote = (node.name for node in evidence.graph.nodes if node.id in evidence.remote)
    return sorted(arbitrate(found, remote), key=lambda finding: -finding.severity)


def in_doubt(evidence: Evidence) -> bool:
    """Return whether there is anything above a note, or a sign of trouble, on a bus in use."""
    if is_empty(evidence):
        return False
    return shows_signs(evidence) or any(
        finding.severity > Severity.NOTE for finding in examine(evidence)
    )


def shows_signs(evidence: Evidence) -> bool:
    """Return whether a longer look may show what this one leaves open."""
    return _has_left(evidence) or any(
        family.is_in_doubt(evidence) for family in (callbacks, listeners, pace, traffic, relays)
    )


def _has_left(evidence: Evidence) -> bool:
    """Return whether a node has left during the look; it may be starting again."""
    names = {node.name for node in evidence.graph.nodes if not node.stale}
    return any(x.name not in names for x in evidence.before.nodes if not (x.tool or x.stale))
