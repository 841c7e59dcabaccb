"""Rules about other computers: the network and their clocks."""

from collections.abc import Iterator

from lcmtools.doctor.evidence import Evidence, HostClock
from lcmtools.doctor.findings import Finding, Severity, Subject, finding, rule, state
from lcmtools.doctor.rules.shared import HOST_NETWORK, MEND_BUS, MORE, PROGRAM, SET_CLOCKS

_LOOPBACK = "lo"
_SHARE = 0.5  # of the capacity of an interface
_WIRELESS = 1e6  # [byte/s] of multicast
_AHEAD = 0.1  # [s] tolerance: a message cannot arrive before it was sent
_BEHIND = 0.3  # [s]: a slow network looks the same
_BEHIND_RELAYS = 1.5  # [s]: a slow line between relays
_MOST = 6  # nodes that are named


@rule(
    "large-messages",
    remedy="let the firewall pass large datagrams of UDP",
    title="A message of {bytes} bytes does not come back: {problem}",
    remedies={
        "look-at-firewall": "see whether a firewall drops large datagrams: `sudo nft list ruleset`",
        "macos-large-datagrams": "macOS: `sudo sysctl -w net.inet.udp.maxdgram=65535`",
    },
    evidence="a message of five datagrams that wtf sends to itself",
)
def large_messages_pass(evidence: Evidence) -> Iterator[Finding]:
    """A message of several full datagrams comes back to this computer, as a small one does.

    wtf sends one to itself, which stays on this computer and which no other program receives. If
    it does not come back, images and point clouds do not arrive either.
    """
    host = evidence.host
    if host.large_problem and not evidence.bus_problem:
        title = state("large-messages", bytes=host.large_bytes, problem=host.large_problem)
        yield from finding(title, None, "look-at-firewall", "macos-large-datagrams")


@rule(
    "sending",
    remedy="lcmtools wtf prints the command that fixes it",
    severity=Severity.ERROR,
    title="Messages cannot leave this computer: {problem}",
    remedies=MEND_BUS,
    evidence="a datagram that wtf sends with the bus's ttl",
)
def datagrams_can_leave(evidence: Evidence) -> Iterator[Finding]:
    """Datagrams with the bus's own ttl can be sent.

    With a ttl above 0 they have to leave the computer, which a firewall (EPERM), a missing route
    (ENETUNREACH) or a full queue of the network card (ENOBUFS) can prevent.
    """
    host = evidence.host
    if host.send_problem and not evidence.bus_problem:
        remedies = [state("mend-bus", hint=host.send_remedy)] if host.send_remedy else []
        title = state("sending", problem=host.send_problem)
        yield from finding(title, None, *remedies)


@rule(
    "link",
    remedy="connect the interface, or: sudo ip route replace 224.0.0.0/4 dev X",
    title="The interface {interface}, to which the route to the bus leads, has no link: nothing"
    " leaves this computer",
    remedies={
        "connect": "plug its cable in, or connect its Wi-Fi",
        "route-to": "or set the route to another interface:"
        " `sudo ip route replace 224.0.0.0/4 dev {interface}`",
    },
    evidence="the interface's carrier, the routing table",
)
def the_interface_has_a_link(evidence: Evidence) -> Iterator[Finding]:
    """The interface to which the route to the bus leads has a link: a cable, or Wi-Fi.

    Without one no message leaves this computer, and no error reports it. It does not matter if
    ttl=0 keeps messages here.
    """
    host = evidence.host
    if evidence.ttl and host.is_up and not host.has_link and not evidence.bus_problem:
        others = (name for name in host.others if name != host.interface)
        remedies = [state("route-to", interface=name) for name in others]
        title = state("link", interface=host.interface)
        yield from finding(title, None, "connect", *remedies[:1])


@rule(
    "loopback-route",
    remedy="sudo ip route replace 224.0.0.0/4 dev eth0",
    severity=Severity.NOTE,
    title="ttl={ttl}, but the route to the bus leads to lo: no other computer receives anything",
    remedies={
        "route": "if they should: `sudo ip route replace 224.0.0.0/4 dev eth0` (with your"
        " interface)",
    },
    evidence="the routing table, the ttl of the URL",
)
def the_route_leaves_the_computer(evidence: Evidence) -> Iterator[Finding]:
    """The route to the bus leaves this computer, if the ttl lets messages leave it."""
    if _is_alone(evidence) and evidence.host.interface == _LOOPBACK:
        title = state("loopback-route", ttl=evidence.ttl)
        yield from finding(title, None, "route")


@rule(
    "container",
    remedy="docker run --network host; WSL: networkingMode=mirrored",
    severity=Severity.NOTE,
    title="This is a {container} with its own network, and no other computer is seen",
    remedies={
        **HOST_NETWORK,
        "mirrored-network": "write networkingMode=mirrored under [wsl2] into"
        " %UserProfile%\\.wslconfig",
        "use-server": "or connect both by a server: LCM_DEFAULT_URL=tcpq://HOST:7700",
    },
    evidence="marks of containers and of WSL in the file system, the interface",
)
def nothing_is_walled_in(evidence: Evidence) -> Iterator[Finding]:
    """The private network of a container or WSL forwards multicast.

    Most do not, so that the bus ends there. Reported if no other computer is seen.
    """
    kind = evidence.host.container
    is_walled = kind == "WSL" or (kind and evidence.host.is_virtual)
    if _is_alone(evidence) and is_walled:
        remedy = "mirrored-network" if kind == "WSL" else "host-network"
        title = state("container", container=kind)
        yield from finding(title, None, remedy, "use-server")


@rule(
    "igmp-querier",
    remedy="echo 1 | sudo tee /sys/class/net/BRIDGE/bridge/multicast_querier",
    severity=Severity.NOTE,
    title="The bridge {bridge} sends no IGMP queries, and no other computer is seen",
    facts={
        "switch-forgets": "if messages stop some minutes after a start, a switch has forgotten the"
        " members of the group",
    },
    remedies={
        "enable-querier": "`echo 1 | sudo tee /sys/class/net/{bridge}/bridge/multicast_querier`",
    },
    evidence="the settings of a bridge on the route",
)
def the_network_has_a_querier(evidence: Evidence) -> Iterator[Finding]:
    """The network has an IGMP querier, which queries for group members.

    Without one, many switches forget the members some minutes after they have started, and messages
    stop. wtf cannot inspect a switch; it can inspect a bridge of this computer, which can send the
    queries for the whole network. Without a querier, the bridge itself forwards everything.
    """
    bridge = evidence.host.bridge
    if _is_alone(evidence) and bridge:
        title, remedy = (state(kind, bridge=bridge) for kind in ("igmp-querier", "enable-querier"))
        yield from finding(title, [state("switch-forgets")], remedy)


@rule(
    "bandwidth",
    remedy="send smaller messages, or less often: lcmtools bw TOPIC",
    title="{interface} is too slow for the bus, which carries {megabytes_per_second:.1f} MB/s:",
    facts={"stream-bandwidth": "{topic} from {sender}: {megabytes_per_second:.2f} MB/s"},
    remedies={"use-ttl-0": "keep what only this computer needs on a bus with ttl=0"},
    evidence="bytes during the look, the interface's speed",
)
def the_network_has_room(evidence: Evidence) -> Iterator[Finding]:
    """The bus does not fill the network.

    Wi-Fi sends multicast at its slowest rate, so that a few images a second can fill it.
    """
    host = evidence.host
    if not evidence.listened or not evidence.ttl or host.interface in ("", "lo"):
        return
    rate = sum(stream.bytes for stream in evidence.streams) / evidence.listened
    limit = _WIRELESS if host.is_wireless else _SHARE * host.speed_mbit * 1e6 / 8
    if limit and rate > limit:
        facts = []
        for s in sorted(evidence.streams, key=lambda stream: -stream.bytes)[:3]:
            rate_of = {"megabytes_per_second": s.bytes / evidence.listened / 1e6}
            facts.append(state("stream-bandwidth", topic=s.channel, sender=s, **rate_of))
        title = state("bandwidth", interface=host.interface, megabytes_per_second=rate / 1e6)
        yield from finding(title, facts, "use-ttl-0")


def _is_alone(evidence: Evidence) -> bool:
    """Return whether other computers could send on the bus, but none does."""
    return evidence.ttl > 0 and not (evidence.has_others() or evidence.bus_problem)


@rule(
    "clocks",
    remedy="sudo timedatectl set-ntp true, on both; or sudo chronyc makestep",
    title={
        "clock-ahead": "The clock of {host:called} is {seconds:time} ahead of this computer's:",
        "clock-behind": "The clock of {host:called} is {seconds:time} behind this computer's:",
    },
    facts=PROGRAM | MORE,
    remedies={
        **SET_CLOCKS,
        "compare-clocks": "compare them: `chronyc tracking`, or `timedatectl timesync-status`",
    },
    evidence="the times in announcements, and their times of arrival",
)
def clocks_agree(evidence: Evidence) -> Iterator[Finding]:
    """The clocks of all computers agree.

    Announcements of nodes contain the time at which they were sent, by their own computer's clock.
    If one arrives before that time, or much later, one of the two clocks is wrong; then stamps,
    delays and everything computed from them are wrong, too. wtf cannot tell which of the two it is.
    """
    for clock in wrong_clocks(evidence):
        facts = [state("program", program=Subject("node", name)) for name in clock.nodes[:_MOST]]
        if len(clock.nodes) > _MOST:
            facts.append(state("more", count=len(clock.nodes) - _MOST))
        kind = "clock-ahead" if clock.lag < 0 else "clock-behind"
        odd = (one.name for one in evidence.oddities if has_wrong_clock(evidence, one.name))
        title = state(kind, host=clock, seconds=abs(clock.lag)).of("far", *odd)
        yield from finding(title, facts, "set-clocks", "compare-clocks")


def wrong_clocks(evidence: Evidence) -> list[HostClock]:
    """Return the computers whose clocks differ from this one's."""
    return [c for c in evidence.clocks if not -_AHEAD <= c.lag <= _most_delay(c)]


def _most_delay(clock: HostClock) -> float:
    """Return the longest delay of an announcement that the network may cause [s]."""
    return _BEHIND if clock.address else _BEHIND_RELAYS


def has_wrong_clock(evidence: Evidence, name: str) -> bool:
    """Return whether a sender, by its displayed name, is on a computer whose clock differs."""
    wrong = wrong_clocks(evidence)
    nodes = {node for one in wrong for node in one.nodes}
    behind = (node for node in evidence.graph.nodes if node.name in nodes)
    # a relay sends what nodes behind it have stamped
    names = nodes | {step.relay for node in behind for step in node.path}
    return name in names or any(name.startswith(f"{one.address}:") for one in wrong)
