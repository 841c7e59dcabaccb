"""Sentences that several families of rules use, and evidence that they share."""

from collections.abc import Set as AbstractSet

from lcmtools.doctor.evidence import Evidence, derived
from lcmtools.observe.simulators import is_simulator

DECODED = "the decoded messages of the look (on a busy bus, a sample)"

MORE = {"more": "and {count} more"}
PROGRAM = {"program": "{program}"}

END_OR_REMAP = {
    "end-one-or-remap": "end one of them{pids:kills}, or start {other} with {old}:={new}"
}
MEND_BUS = {"mend-bus": "{hint:advice}`{hint:command}`"}
HOST_NETWORK = {"host-network": "start the container with: --network host"}
SET_CLOCKS = {"set-clocks": "synchronize both computers' clocks: `sudo timedatectl set-ntp true`"}
WAKE_OR_END = {"wake-or-end": "wake it (`kill -CONT {pid}`) or end it (`kill -KILL {pid}`)"}


@derived
def simulator_ids(evidence: Evidence) -> AbstractSet[str]:
    """Return the ids of the simulators, which are searched once: they have many endpoints."""
    return {node.id for node in evidence.graph.nodes if is_simulator(node)}
