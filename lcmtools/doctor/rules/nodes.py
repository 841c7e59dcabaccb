"""Rules about nodes."""

from collections import defaultdict
from collections.abc import Iterator

from lcmtools.doctor.model import Evidence, Finding, Severity
from lcmtools.graph.model import Node, Staleness


def nodes_answer(evidence: Evidence) -> Iterator[Finding]:
    """Every node that was there and did not say goodbye still answers."""
    nodes = evidence.graph.nodes
    alive = {node.name for node in nodes if not node.stale}
    stale = [
        node
        for node in nodes
        if node.stale
        and not node.is_hidden  # a command that was killed is no part of the system
        and (_runs(node) or node.name not in alive)  # it has been started again
    ]
    if stale:
        yield Finding(
            "stale-nodes",
            Severity.ERROR,
            "The following nodes do not answer any more:",
            tuple(f" * {node.name} (pid {node.pid}): {node.stale}" for node in stale),
            tuple(_remedy(node) for node in stale),
        )


def nodes_have_names_of_their_own(evidence: Evidence) -> Iterator[Finding]:
    """No two nodes have the same name."""
    by_name: dict[str, list[Node]] = defaultdict(list)
    for node in evidence.graph.nodes:
        if not node.stale:
            by_name[node.name].append(node)
    for name, nodes in by_name.items():
        if len(nodes) > 1:
            yield Finding(
                "duplicate-names",
                Severity.ERROR,
                f"{len(nodes)} nodes have the name {name}:",
                tuple(f" * pid {node.pid} on {node.host}: {node.command}" for node in nodes),
                (f"end one of them, or start it with __name:={name.rpartition('/')[2]}2",),
            )


def _runs(node: Node) -> bool:
    return node.stale is not Staleness.ENDED


def _remedy(node: Node) -> str:
    if _runs(node):
        return f"wake it (kill -CONT {node.pid}) or end it (kill {node.pid})"
    return f"start {node.name} again, or forget it: lcmtools node cleanup"
