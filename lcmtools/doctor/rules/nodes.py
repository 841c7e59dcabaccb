"""Rules about nodes."""

from collections import defaultdict
from collections.abc import Iterator

from lcmtools.doctor.model import Evidence, Finding, Severity, rule
from lcmtools.graph.model import Node, Staleness


@rule("stale-nodes", Severity.ERROR, "wake it: kill -CONT PID; or forget it: lcmtools node cleanup")
def nodes_answer(evidence: Evidence) -> Iterator[Finding]:
    """Every node that was there and did not say goodbye still answers.

    One that does not was killed, is stopped, or its computer is gone.
    """
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
            tuple(f" * {node.name} ({_place(evidence, node)}): {node.stale}" for node in stale),
            tuple(_remedy(evidence, node) for node in stale),
        )


@rule("duplicate-names", Severity.ERROR, "start one of them with __name:=ANOTHER")
def nodes_have_names_of_their_own(evidence: Evidence) -> Iterator[Finding]:
    """No two nodes have the same name.

    Often an old process was left over. Commands that take a node's name cannot tell them apart.
    """
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


@rule(
    "no-clock",
    Severity.ERROR,
    "start the simulator, or the node without _use_sim_time:=true",
)
def simulated_time_has_a_source(evidence: Evidence) -> Iterator[Finding]:
    """Somebody publishes the time by which nodes go.

    For a node with _use_sim_time:=true, time stands still until something comes on /clock: its
    timers never run.
    """
    topic = evidence.graph.topic(_CLOCK)
    waiting = [node for node, _ in topic.subscribers if not (node.stale or node.tool)]
    sources = [node for node, _ in topic.publishers if not node.stale]
    # one that was killed or hangs is another rule's
    if waiting and not (sources or topic.foreign or _CLOCK in evidence.hushed):
        yield Finding(
            "no-clock",
            Severity.ERROR,
            "The following nodes go by simulated time, and nobody publishes /clock:",
            tuple(f" * {node.name} (pid {node.pid})" for node in waiting),
            (
                *(f"start {node.name} without _use_sim_time:=true" for node in waiting),
                "or start the simulator, for example: lcmtools run sim",
            ),
        )


@rule("open-files", Severity.WARNING, "close what is not needed; ulimit -n raises the limit")
def files_are_few(evidence: Evidence) -> Iterator[Finding]:
    """No program has nearly as many files open as it may.

    liblcm also fails, by a crash, once its own file descriptor is 1024 or more.
    """
    rows = [
        f" * pid {p.pid} has {p.open_files} of {p.most_files} files open: {p.command}"
        for p in evidence.processes
        if not p.bus and p.open_files > _MOST_FILES * min(p.most_files or _SELECT, _SELECT)
    ]
    if rows:
        text = "The following programs have nearly as many files open as LCM stands:"
        yield Finding("open-files", Severity.WARNING, text, tuple(rows), ("restart them",))


_CLOCK = "/clock"
_SELECT = 1024  # liblcm's binding waits with select(2)
_MOST_FILES = 0.9


def _runs(node: Node) -> bool:
    return node.stale is not Staleness.ENDED


def _place(evidence: Evidence, node: Node) -> str:
    """A node's process, and its computer where that is not this one."""
    if node.id not in evidence.remote:
        return f"pid {node.pid}"
    address = f" at {node.sender.address}" if node.sender else ""
    return f"pid {node.pid} on {node.host}{address}"


def _remedy(evidence: Evidence, node: Node) -> str:
    if node.id in evidence.remote:
        return f"see whether {node.host} is reached and the node runs: lcmtools wtf, typed there"
    if _runs(node):
        return f"wake it (kill -CONT {node.pid}) or end it (kill {node.pid})"
    return f"start {node.name} again, or forget it: lcmtools node cleanup"
