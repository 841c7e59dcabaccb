"""The parts that could not be looked at, with the reason: from the evidence, as the rules are."""

from collections.abc import Iterator

from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import Unchecked, state

_ROOT = 0
_OF_SOCKETS = ("kernel-drops", "stuck-listeners", "small-buffer", "interfaces", "other-users")
_OF_NETWORK = ("link", "bandwidth", "rp-filter", "igmp-querier")


def unchecked(evidence: Evidence) -> Iterator[Unchecked]:
    """The parts that the rules could not look at; nothing where the bus does not work at all."""
    if evidence.bus_problem:
        return
    provider = evidence.url.partition("://")[0]
    if provider == "udpm":
        yield from _of_sockets(evidence)
        yield from _of_network(evidence)
    elif provider in ("tcpq", "mpudpm"):
        yield Unchecked("loss", state("no-senders", provider=provider))
    elif provider == "zenoh":
        yield Unchecked("loss", state("zenoh-losses"))


def _of_sockets(evidence: Evidence) -> Iterator[Unchecked]:
    host, own = evidence.host, evidence.host.uid
    if not host.has_sockets:
        yield from (Unchecked(rule, state("no-sockets")) for rule in _OF_SOCKETS)
        yield Unchecked("other-buses", state("no-processes"))
        return
    hidden = {listener.uid for listener in evidence.listeners if listener.pid is None} - {own}
    if hidden and own != _ROOT:
        users = [evidence.users.get(uid, str(uid)) for uid in sorted(hidden)]
        yield Unchecked("stuck-listeners", state("hidden-programs", users=users))
    if any(listener.buffer_bytes is None for listener in evidence.listeners):
        yield Unchecked("small-buffer", state("buffers-unknown"))


def _of_network(evidence: Evidence) -> Iterator[Unchecked]:
    """On a bus that stays on this computer none of it matters."""
    host = evidence.host
    if not evidence.ttl:
        return
    if host.firewall_unknown:
        yield Unchecked("firewall", state("text", text=host.firewall_unknown))
    if not host.has_sockets:
        yield from (Unchecked(rule, state("no-network")) for rule in _OF_NETWORK)
    elif host.interface not in ("", "lo") and not host.is_wireless and not host.speed_mbit:
        yield Unchecked("bandwidth", state("bandwidth-unknown", interface=host.interface))
