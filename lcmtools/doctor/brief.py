"""Brief looks: 0.7 s are enough if every program is a node that answered.

Nodes count their own messages, losses and callbacks, so that a look of any length shows them.
Programs that announce nothing, and slow topics, need a look of a whole second.
"""

from collections.abc import Iterator
from itertools import pairwise

from lcmtools.doctor.evidence import Evidence, Stream
from lcmtools.doctor.findings import Severity
from lcmtools.doctor.rules import callbacks, examine, listeners, pace, relays, traffic
from lcmtools.graph.model import Endpoint, Node, Role
from lcmtools.names import is_hidden
from lcmtools.observe.measuring.counters import busy_share

BRIEF = 0.7  # the duration of such a look, with the request for the nodes' counters at its end [s]
WHOLE = 1.0  # the default duration of a look if a brief one is not enough [s]
_RESTART = 3.0  # [s] in which a node that was ended to be started again is back
_SLOWEST = 1_200_000_000  # [ns] the longest interval that a whole look shows
_BUSY = 0.5  # share of time in callbacks: a call may be longer than a brief look


def is_enough(evidence: Evidence) -> bool:
    """Return whether a longer look would show nothing more."""
    return (
        _has_only_nodes(evidence)
        and not any(_silent_publishers(evidence))
        and not any(_is_uneven(stream) for stream in evidence.streams)
        and not any((busy_share(*pair) or 0.0) > _BUSY for pair in _earlier_and_now(evidence))
        and not pace.may_have_fallen(evidence)
        and not needed_duration(evidence)
        and all(finding.severity is Severity.NOTE for finding in examine(evidence))
    )


def needed_duration(evidence: Evidence) -> float:
    """Return the duration of a look [s] that shows what rules suspect; 0 if they suspect none."""
    suspicions = (
        callbacks.needed_duration(evidence),
        listeners.needed_duration(evidence),
        pace.needed_duration(evidence),
        traffic.needed_duration(evidence),
        relays.needed_duration(evidence),
        _RESTART if _has_left(evidence) else 0.0,
    )
    return max(suspicions)


def _has_left(evidence: Evidence) -> bool:
    """Return whether a node has left during the look; it may be starting again."""
    names = {node.name for node in evidence.graph.nodes if not node.stale}
    return any(x.name not in names for x in evidence.before.nodes if not (x.tool or x.stale))


def _has_only_nodes(evidence: Evidence) -> bool:
    """Return whether only nodes of this computer can send, and every one of them is known."""
    is_local = evidence.url.startswith("udpm://") and not (evidence.ttl or evidence.remote)
    strangers_listen = any(not (one.is_node or one.is_tool) for one in evidence.listeners)
    is_known = evidence.host.has_sockets and not (evidence.plain_programs() or strangers_listen)
    return is_local and is_known and not (evidence.graph.foreign() or evidence.own_drops)


def _earlier_and_now(evidence: Evidence) -> Iterator[tuple[Node, Node]]:
    """Yield each live node at the start and the end of the look; a new node twice as it is now."""
    before = {node.id: node for node in evidence.before.nodes}
    for node in evidence.graph.nodes:
        if not (node.tool or node.stale):
            yield before.get(node.id, node), node


def _silent_publishers(evidence: Evidence) -> Iterator[Endpoint]:
    """Yield the publishers that sent in the last second, but not during the look."""
    for was, node in _earlier_and_now(evidence):
        counts = {end.key: end.messages for end in was.endpoints}
        for end in node.having(Role.PUBLISHER):
            is_recent = evidence.graph.time - end.last_time < _SLOWEST
            if is_recent and end.messages == counts.get(end.key) and not is_hidden(end.topic):
                yield end


def _is_uneven(stream: Stream) -> bool:
    usual = pace.usual_interval(stream)
    if not usual:
        return False
    longest = max(later - one for one, later in pairwise(stream.times)) / 1e9
    return longest > max(pace.SHORTEST, pace.UNEVEN * usual)
