"""Rules about the way to other computers, for buses whose messages may leave this one."""

from collections.abc import Iterator

from lcmtools.doctor.model import Evidence, Finding, Severity, rule

_LOOPBACK = "lo"


@rule("large-messages", Severity.WARNING, "let the firewall pass large datagrams of UDP")
def large_messages_pass(evidence: Evidence) -> Iterator[Finding]:
    """A message of several full datagrams comes back to this computer, as a small one does.

    wtf sends one to itself, which stays on this computer and which no other program hears. Where it
    does not come, images and point clouds do not come either.
    """
    problem = evidence.host.large_problem
    if problem and not evidence.bus_problem:
        yield Finding(
            "large-messages",
            Severity.WARNING,
            f"A message of {evidence.host.large_bytes} bytes does not come back: {problem}",
            remedies=(
                "see whether a firewall drops large datagrams: sudo nft list ruleset",
                "macOS: sudo sysctl -w net.inet.udp.maxdgram=65535",
            ),
        )


@rule("sending", Severity.ERROR, "lcmtools wtf prints the command that mends it")
def datagrams_can_leave(evidence: Evidence) -> Iterator[Finding]:
    """Datagrams with the bus's own ttl can be sent.

    With a ttl above 0 they have to leave the computer, which a firewall (EPERM), a missing route
    (ENETUNREACH) or a full queue of the network card (ENOBUFS) can forbid.
    """
    if evidence.host.send_problem and not evidence.bus_problem:
        remedies = (evidence.host.send_remedy,) if evidence.host.send_remedy else ()
        text = f"Messages cannot leave this computer: {evidence.host.send_problem}"
        yield Finding("sending", Severity.ERROR, text, (), remedies)


@rule("loopback-route", Severity.NOTE, "sudo ip route replace 224.0.0.0/4 dev eth0")
def the_route_leaves_the_computer(evidence: Evidence) -> Iterator[Finding]:
    """Where the ttl lets messages leave this computer, the route does too."""
    if _is_alone(evidence) and evidence.host.interface == _LOOPBACK:
        yield Finding(
            "loopback-route",
            Severity.NOTE,
            f"ttl={evidence.ttl}, but the route to the bus leads to lo: no other computer hears it",
            remedies=(
                "where they should: sudo ip route replace 224.0.0.0/4 dev eth0 (your interface)",
            ),
        )


@rule("container", Severity.NOTE, "docker run --network host; WSL: networkingMode=mirrored")
def nothing_is_walled_in(evidence: Evidence) -> Iterator[Finding]:
    """The network that a container or WSL has to itself passes multicast on.

    Most do not, so that a bus ends at its wall. Said where no other computer is heard.
    """
    kind = evidence.host.container
    is_walled = kind == "WSL" or (kind and evidence.host.is_virtual)
    if _is_alone(evidence) and is_walled:
        remedy = "start the container with: --network host"
        if kind == "WSL":
            remedy = "write networkingMode=mirrored under [wsl2] into %UserProfile%\\.wslconfig"
        yield Finding(
            "container",
            Severity.NOTE,
            f"This is a {kind} with a network of its own, and no other computer is heard",
            remedies=(remedy, "or join both by a server: LCM_DEFAULT_URL=tcpq://HOST:7700"),
        )


@rule(
    "igmp-querier",
    Severity.NOTE,
    "echo 1 | sudo tee /sys/class/net/BRIDGE/bridge/multicast_querier",
)
def somebody_asks_who_listens(evidence: Evidence) -> Iterator[Finding]:
    """Somebody in the network asks who listens (an IGMP querier).

    Where nobody does, many switches forget the listeners some minutes after these have started,
    and messages stop. A switch cannot be looked at from here; a bridge of this computer can, and
    it can ask for the whole network. It passes everything on itself as long as nobody asks.
    """
    bridge = evidence.host.bridge
    if _is_alone(evidence) and bridge:
        yield Finding(
            "igmp-querier",
            Severity.NOTE,
            f"The bridge {bridge} does not ask who listens (IGMP), and no other computer is heard",
            (" * if messages stop some minutes after a start, a switch has forgotten who listens",),
            (f"echo 1 | sudo tee /sys/class/net/{bridge}/bridge/multicast_querier",),
        )


def _is_alone(evidence: Evidence) -> bool:
    """Whether other computers should be heard, and none is."""
    heard = any(not sender.is_local for sender in evidence.senders)
    return evidence.ttl > 0 and not heard and not evidence.bus_problem
