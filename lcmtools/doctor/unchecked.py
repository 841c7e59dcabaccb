"""What could not be looked at, with the reason: from the evidence, as the rules are."""

from collections.abc import Iterator

from lcmtools.doctor.model import Evidence, Unchecked

_ROOT = 0


def unchecked(evidence: Evidence) -> Iterator[Unchecked]:
    """What the rules could not look at. Nothing where the bus does not work, which comes first."""
    if evidence.bus_problem:
        return
    provider = evidence.url.partition("://")[0]
    if provider == "udpm":
        yield from _of_sockets(evidence)
        yield from _of_network(evidence)
    elif provider in ("tcpq", "mpudpm"):
        yield Unchecked("loss", f"{provider} does not let wtf see who sends, and what is missing")


def _of_sockets(evidence: Evidence) -> Iterator[Unchecked]:
    host, own = evidence.host, evidence.host.uid
    if not host.has_sockets:
        why = "this system does not tell what its sockets drop (it has no /proc/net/udp)"
        yield Unchecked("kernel-drops", why)
        return
    hidden = {listener.uid for listener in evidence.listeners if listener.pid is None} - {own}
    if hidden and own != _ROOT:
        who = ", ".join(evidence.users.get(uid, str(uid)) for uid in sorted(hidden))
        why = f"programs of other users ({who}) are hidden from you: sudo lcmtools wtf looks closer"
        yield Unchecked("stuck-listeners", why)
    if any(listener.buffer_bytes is None for listener in evidence.listeners):
        why = "this system does not tell how large the listeners' buffers are"
        yield Unchecked("small-buffer", why)


def _of_network(evidence: Evidence) -> Iterator[Unchecked]:
    """On a bus that stays on this computer none of it matters."""
    host = evidence.host
    if not evidence.ttl:
        return
    if host.firewall_unknown:
        yield Unchecked("firewall", host.firewall_unknown)
    if host.interface not in ("", "lo") and not host.is_wireless and not host.speed_mbit:
        why = f"{host.interface} does not say how much it carries"
        yield Unchecked("bandwidth", why)
