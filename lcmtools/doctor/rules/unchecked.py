"""Rules that lack evidence, with the reasons."""

from collections.abc import Iterable, Iterator

from lcmtools.doctor.evidence import Evidence
from lcmtools.doctor.findings import Part, Subject, Unchecked, state
from lcmtools.errors import InvalidFile, UnknownType
from lcmtools.messages.registry import message_class

_ROOT = 0
_OF_SOCKETS = ("kernel-drops", "stuck-listeners", "small-buffer", "interfaces", "other-users")
_REASONS = {
    "bandwidth-unknown": "{interface} reports no speed",
    "clocks-unknown": "no announcement of {hosts:list} tells when it was sent",
    "buffers-unknown": "this system does not report the size of the listeners' buffers",
    "hidden-programs": "programs of other users ({users:list}) are hidden from you: sudo lcmtools"
    " wtf shows them",
    "zenoh-losses": "wtf does not count losses on Zenoh; lcmtools hz TOPIC does",
    "no-senders": "on {provider}, wtf cannot see senders and losses",
    "no-network": "this system does not report its routes and interfaces (it has no /proc/net)",
    "no-processes": "this system does not report the sockets of programs (it has no /proc)",
    "no-sockets": "this system does not list its sockets (it has no /proc/net/udp)",
    "text": "{text}",
    "unusable-types": "{types:list} cannot be used: lcmtools msg list says why",
}
_OF_NETWORK = ("link", "bandwidth", "rp-filter", "igmp-querier")


def unchecked(evidence: Evidence) -> Iterator[Unchecked]:
    """Yield the rules that lack evidence; none if the bus does not work at all."""
    if evidence.bus_problem:
        return
    provider = evidence.url.partition("://")[0]
    if provider == "udpm":
        yield from _of_sockets(evidence)
        yield from _of_network(evidence)
    elif provider in ("tcpq", "mpudpm"):
        yield _unchecked("loss", "no-senders", provider=provider)
    elif provider == "zenoh":
        yield _unchecked("loss", "zenoh-losses")
    yield from _of_clocks(evidence)
    announced = sorted({name for topic in evidence.graph.topics() for name in topic.types})
    if types := [name for name in announced if not _is_usable(name)]:
        yield _unchecked("type-mismatch", "unusable-types", types=types)


def _is_usable(name: str) -> bool:
    """Return False for a type whose file is wrong; one without a file is no fault."""
    try:
        message_class(name, any_version=True)
    except InvalidFile:
        return False
    except UnknownType:
        pass
    return True


def _of_clocks(evidence: Evidence) -> Iterator[Unchecked]:
    """Yield the rule about clocks for the computers whose clocks could not be compared."""
    compared = {name for clock in evidence.clocks for name in clock.nodes}
    remote = [x for x in evidence.graph.nodes if x.id in evidence.remote and not x.stale]
    known = {node.host for node in remote if node.name in compared}
    hosts = sorted({node.host for node in remote} - known)
    if hosts:
        yield _unchecked("clocks", "clocks-unknown", hosts=hosts)


def _of_sockets(evidence: Evidence) -> Iterator[Unchecked]:
    host, own = evidence.host, evidence.host.uid
    if not host.has_sockets:
        yield from (_unchecked(rule, "no-sockets") for rule in _OF_SOCKETS)
        yield _unchecked("other-buses", "no-processes")
        return
    hidden = {listener.uid for listener in evidence.listeners if listener.pid is None} - {own}
    if hidden and own != _ROOT:
        users = [evidence.users.get(uid, str(uid)) for uid in sorted(hidden)]
        yield _unchecked("stuck-listeners", "hidden-programs", users=users)
    sizes = {listener.buffer_bytes for listener in evidence.listeners}
    if sizes == {None}:  # else a program has closed its socket meanwhile
        yield _unchecked("small-buffer", "buffers-unknown")


def _of_network(evidence: Evidence) -> Iterator[Unchecked]:
    """Yield rules about the network, which do not matter on a local bus."""
    host = evidence.host
    if not evidence.ttl:
        return
    if host.firewall_unknown:
        yield _unchecked("firewall", "text", text=host.firewall_unknown)
    if not host.has_sockets:
        yield from (_unchecked(rule, "no-network") for rule in _OF_NETWORK)
    elif host.interface not in ("", "lo") and not host.is_wireless and not host.speed_mbit:
        yield _unchecked("bandwidth", "bandwidth-unknown", interface=host.interface)


def _unchecked(rule: str, reason: str, **parts: Part | Iterable[Subject | str]) -> Unchecked:
    return Unchecked(rule, state(reason, **parts).worded(_REASONS))
