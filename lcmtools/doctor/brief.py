"""Brief looks: most of a second is enough where every program is a node that was heard.

Nodes count their own messages, losses and callbacks, so that a look of any length shows them. What
only listening shows takes a whole second: programs that announce nothing, and slow topics.
"""

from collections.abc import Iterator
from itertools import pairwise

from lcmtools.doctor.evidence import Evidence, Stream
from lcmtools.doctor.findings import Severity
from lcmtools.doctor.rules import examine, pace
from lcmtools.graph.model import Endpoint, Node, Role
from lcmtools.names import is_hidden
from lcmtools.observe.measuring.counters import busy_share

BRIEF = 0.7  # the duration of such a look, with the request for the nodes' counters at its end [s]
WHOLE = 1.0  # the duration of a look that nobody chose, where a brief one is not enough [s]
_SLOWEST = 1_200_000_000  # [ns] between messages that a whole look shows: a little more than 1 Hz
_BUSY = 0.5  # of the time in callbacks: a call may not have ended in a brief look


def is_enough(evidence: Evidence) -> bool:
    """Return whether a whole look would show nothing that this brief one does not."""
    return (
        _has_only_nodes(evidence)
        and not any(_silent_publishers(evidence))
        and not any(_is_uneven(stream) for stream in evidence.streams)
        and not any((busy_share(*pair) or 0.0) > _BUSY for pair in _earlier_and_now(evidence))
        and not pace.may_have_fallen(evidence)
        and all(finding.severity is Severity.NOTE for finding in examine(evidence))
    )


def _has_only_nodes(evidence: Evidence) -> bool:
    """Return whether all that may send are nodes of this computer, and none was missed."""
    nodes = {node.pid for node in evidence.own_nodes()}
    is_local = evidence.url.startswith("udpm://") and not (evidence.ttl or evidence.remote)
    strangers = [one for one in evidence.processes if not one.bus and one.pid not in nodes]
    strangers_listen = any(not (one.is_node or one.is_tool) for one in evidence.listeners)
    is_known = evidence.host.has_sockets and not (strangers or strangers_listen)
    return is_local and is_known and not (evidence.graph.foreign() or evidence.own_drops)


def _earlier_and_now(evidence: Evidence) -> Iterator[tuple[Node, Node]]:
    """Each living node as it was and as it is; one that came meanwhile, twice as it is."""
    before = {node.id: node for node in evidence.before.nodes}
    for node in evidence.graph.nodes:
        if not (node.tool or node.stale):
            yield before.get(node.id, node), node


def _silent_publishers(evidence: Evidence) -> Iterator[Endpoint]:
    """The publishers of the last second that sent nothing in the look."""
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
