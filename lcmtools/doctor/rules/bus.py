"""Rules about the bus itself."""

from collections.abc import Iterator

from lcmtools.doctor.model import Evidence, Finding, Severity
from lcmtools.graph.model import Role
from lcmtools.names import is_hidden


def bus_works(evidence: Evidence) -> Iterator[Finding]:
    """The bus can be reached: the URL, the route, the way back to this host."""
    if evidence.bus_problem:
        remedies = (evidence.bus_remedy,) if evidence.bus_remedy else ()
        yield Finding(
            "bus", Severity.ERROR, f"The bus does not work: {evidence.bus_problem}", (), remedies
        )


def something_is_there(evidence: Evidence) -> Iterator[Finding]:
    """There is any node or any message on the bus."""
    if evidence.bus_problem:
        return
    seen = any(not is_hidden(traffic.channel) for traffic in evidence.graph.traffic)
    nodes = any(not node.tool or node.having(Role.PUBLISHER) for node in evidence.graph.nodes)
    if not seen and not nodes:
        yield Finding(
            "no-traffic",
            Severity.WARNING,
            f"There are no nodes on {evidence.url}, and nothing came in {evidence.listened:g} s",
            remedies=(
                "start something, for example: lcmtools run talker",
                (
                    "if it runs already, it is on another bus: compare LCM_DEFAULT_URL and"
                    " LCMTOOLS_DOMAIN in both shells"
                ),
            ),
        )


def datagrams_are_lcm(evidence: Evidence) -> Iterator[Finding]:
    """What comes over the bus is LCM's."""
    if evidence.malformed:
        yield Finding(
            "malformed",
            Severity.WARNING,
            "The following senders put datagrams on the bus that are none of LCM's:",
            tuple(f" * {sender}: {reason}" for sender, reason in evidence.malformed),
            ("find the program with: ss -uanp",),
        )
