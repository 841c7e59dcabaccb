"""Rules about services."""

from collections import defaultdict
from collections.abc import Iterator

from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import Finding, Statement, finding, rule, state, subject
from lcmtools.doctor.renaming import REMAPS, give_reason, near_names, remap_argument, start_with
from lcmtools.doctor.rules.shared import END_OR_REMAP
from lcmtools.graph.model import Node, Role
from lcmtools.names import base_name_of, is_hidden


@rule(
    "services",
    remedy="start one of them with OLD:=NEW, or the node that offers what is called",
    title={
        "services": "The following services are offered by more than one node, and each executes a"
        " request:",
        "unconnected-clients": "The following call services that no node offers:",
    },
    facts={"calls": "{node} calls {service}", "offered": "{service}: {nodes:and}"},
    remedies={
        **REMAPS,
        **END_OR_REMAP,
        "start-server": "start a node that offers {service}; to see what is offered:"
        " `lcmtools service list`",
    },
    evidence="announcements",
)
def services_are_offered_once(evidence: Evidence) -> Iterator[Finding]:
    """Services that nodes call are offered, and by one node each.

    Where two offer one, each executes a request, and the first response is used. Two nodes of one
    name, and nodes that were killed or hang, are reported by other rules.
    """
    offered: dict[str, dict[str, Node]] = defaultdict(dict)  # by service and node
    for node in evidence.graph.nodes:
        for end in node.having(Role.SERVICE):
            if not is_hidden(end.topic):
                offered[end.topic][node.name] = node
    facts, remedies = [], []
    for name, nodes in sorted(offered.items()):
        if len(live := [node for node in nodes.values() if not node.stale]) > 1:
            facts.append(state("offered", service=name, nodes=map(subject, live)))
            remedies.append(_separation(evidence, name, live))
    yield from finding("services", facts, *remedies)
    if any(x.stale and not x.is_hidden for x in evidence.graph.nodes):  # it may offer the service
        return
    callers = [node for node in evidence.graph.nodes if not node.tool]
    calls = [(node, end.topic) for node in callers for end in node.having(Role.CLIENT)]
    calling = [(n, name) for n, name in calls if not (is_hidden(name) or name in offered)]
    facts = [state("calls", node=node, service=name) for node, name in calling]
    remedies = [_connection_remedy(node, name, list(offered)) for node, name in calling]
    yield from finding("unconnected-clients", facts, *remedies)


def _separation(evidence: Evidence, service: str, nodes: list[Node]) -> Statement:
    pids = tuple(str(node.pid) for node in nodes if node.id not in evidence.remote)
    old = remap_argument(nodes[-1], service).partition(":=")[0] or service
    known = {"pids": pids if len(pids) > 1 else (), "old": old, "new": f"{service}_2"}
    return state("end-one-or-remap", other=nodes[-1], **known)


def _connection_remedy(node: Node, service: str, offered: list[str]) -> Statement:
    """Return a remap to a service of a similar name, or of the same name in another namespace."""
    meant = [one for one in offered if base_name_of(one) == base_name_of(service)]
    for other in (*meant, *near_names(service, offered)):
        return give_reason(start_with(node, service, other), "offered", channel=other)
    return state("start-server", service=service)
