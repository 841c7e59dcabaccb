"""Doubts that a second leaves, and that some more seconds clear up.

Collecting evidence judges nothing: it is handed ``in_doubt`` or ``shows_signs``, looks on if that
returns True, and all rules judge once at the end. No rule speaks of durations.
"""

from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import Severity
from lcmtools.doctor.rules import callbacks, examine, listeners, pace, relays, traffic
from lcmtools.doctor.rules.bus import is_empty

_SIGNS = (
    callbacks.is_in_doubt,
    listeners.is_in_doubt,
    pace.is_in_doubt,
    traffic.is_in_doubt,
    relays.is_in_doubt,
)


def in_doubt(evidence: Evidence) -> bool:
    """Return whether there is anything above a note, or a sign of trouble, on a bus in use."""
    if is_empty(evidence):
        return False
    return shows_signs(evidence) or any(
        finding.severity > Severity.NOTE for finding in examine(evidence)
    )


def shows_signs(evidence: Evidence) -> bool:
    """Return whether a longer look may show what this one leaves open."""
    return _has_left(evidence) or any(sign(evidence) for sign in _SIGNS)


def _has_left(evidence: Evidence) -> bool:
    """Return whether a node has left during the look; it may be starting again."""
    names = {node.name for node in evidence.graph.nodes if not node.stale}
    return any(x.name not in names for x in evidence.before.nodes if not (x.tool or x.stale))
