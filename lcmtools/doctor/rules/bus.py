"""Rules about the bus itself."""

from collections.abc import Iterator

from lcmtools.doctor.computers import Host
from lcmtools.doctor.model import Evidence, Finding, LcmProcess, Severity, rule
from lcmtools.doctor.rules.connections import missed_topics
from lcmtools.graph.model import Role
from lcmtools.names import is_hidden

_MOST, _MOST_REMEDIES = 8, 3  # that are shown of other buses


@rule("bus", Severity.ERROR, "lcmtools wtf prints the command that mends the route or the firewall")
def bus_works(evidence: Evidence) -> Iterator[Finding]:
    """The bus can be reached: there is a route to the group, and what is sent comes back.

    Without either LCM's programs freeze for ten seconds when they start, or hear nothing.
    """
    if evidence.bus_problem:
        # what bears on multicast only says nothing of a server
        host, items = evidence.host if "udpm://" in evidence.url else Host(), []
        if not host.is_up:
            items.append(f" * the interface {host.interface or 'lo'} is down")
        if host.interface and not host.can_multicast:
            items.append(f" * the interface {host.interface} has no multicast flag")
        if host.firewall:
            items.append(f" * the firewall {host.firewall} is enabled")
        if host.container and host.interface:
            items.append(f" * this is a {host.container}, which may pass no multicast on")
        remedies = [evidence.bus_remedy] if evidence.bus_remedy else []
        if host.container == "container" and host.interface:
            remedies.append("start the container with: --network host")
        yield Finding(
            "bus",
            Severity.ERROR,
            f"The bus does not work: {evidence.bus_problem}",
            tuple(items),
            tuple(remedies),
        )


@rule(
    "no-traffic", Severity.WARNING, "start a node, or choose the bus it is on: --lcm-url, --domain"
)
def something_is_there(evidence: Evidence) -> Iterator[Finding]:
    """There is any node or any message on the bus. Where there is none, it may be the wrong bus.

    A note where programs are there that are no nodes: they may have nothing to say.
    """
    if evidence.bus_problem:
        return
    if _is_empty(evidence):
        there = {f" * {one.name} listens": None for one in evidence.listeners if not one.is_tool}
        yield Finding(
            "no-traffic",
            Severity.NOTE if there else Severity.WARNING,
            f"There are no nodes on {evidence.url}, and nothing came in {evidence.listened:g} s",
            tuple(there),
            remedies=(
                "start something, for example: lcmtools run talker",
                (
                    "if it runs already, it is on another bus: compare LCM_DEFAULT_URL and"
                    " LCMTOOLS_DOMAIN in both shells"
                ),
            ),
        )


@rule("malformed", Severity.WARNING, "let the program send to another port, or choose another bus")
def datagrams_are_lcm(evidence: Evidence) -> Iterator[Finding]:
    """What comes over the bus is LCM's.

    Other programs' datagrams on its port can end programs of the lcm package.
    """
    if evidence.malformed:
        yield Finding(
            "malformed",
            Severity.WARNING,
            "The following senders put datagrams on the bus that are none of LCM's:",
            tuple(f" * {sender}: {reason}" for sender, reason in evidence.malformed),
            ("let them send elsewhere, or end them; who is on which port: ss -uanp",),
        )


@rule("other-buses", Severity.WARNING, "export LCM_DEFAULT_URL with the same value in every shell")
def everybody_is_here(evidence: Evidence) -> Iterator[Finding]:
    """Programs of this user are on the bus that is looked at.

    Said where the bus is empty, or what a subscription waits for is published on another bus.
    """
    if evidence.bus_problem:
        return
    is_empty = _is_empty(evidence)
    wanted = missed_topics(evidence)
    others = [
        p
        for p in evidence.processes
        if p.bus and not _has_mpudpm(p) and (is_empty or wanted & set(p.topics))
    ]
    if others:
        more = (f" * and {len(others) - _MOST} more",) if len(others) > _MOST else ()
        remedies = {f"export LCM_DEFAULT_URL='udpm://{p.bus}?ttl=0'": None for p in others}
        topics = sorted(wanted & {topic for p in others for topic in p.topics})
        heard = f", with {' and '.join(topics)}" if topics else ""
        yield Finding(
            "other-buses",
            Severity.WARNING,
            f"The following programs of yours are on other buses{heard}:",
            (*map(_whereabouts, others[:_MOST]), *more),
            tuple(remedies) if len(remedies) <= _MOST_REMEDIES else (),
        )


def _is_empty(evidence: Evidence) -> bool:
    """Whether there is neither a node nor a message on the bus."""
    seen = any(not is_hidden(traffic.channel) for traffic in evidence.graph.traffic)
    nodes = any(not node.tool or node.having(Role.PUBLISHER) for node in evidence.graph.nodes)
    return not seen and not nodes


def _whereabouts(process: LcmProcess) -> str:
    variable = f" ({process.variable})" if process.variable else ""
    return f" * pid {process.pid} on {process.bus}{variable}: {process.command}"


@rule("mpudpm", Severity.WARNING, "give all programs the same kind of URL, udpm:// or mpudpm://")
def one_provider_is_used(evidence: Evidence) -> Iterator[Finding]:
    """All programs use the same kind of bus.

    mpudpm spreads channels over many ports; who listens with udpm hears only those on its own.
    """
    if not evidence.url.startswith("udpm"):
        return
    names = {s.sender: s.name for s in evidence.senders}
    internal = [t.sender for t in evidence.graph.traffic if t.channel.startswith("#!mpudpm")]
    foreign = {names.get(sender, str(sender)): None for sender in internal if sender}
    # one that only sends is not heard at all: its variables tell
    foreign |= {f"{p.command} (pid {p.pid})": None for p in evidence.processes if _has_mpudpm(p)}
    if foreign:
        yield Finding(
            "mpudpm",
            Severity.WARNING,
            "The following programs use mpudpm, which is not the udpm of this bus:",
            tuple(f" * {name}" for name in sorted(foreign)),
            (f"start them with LCM_DEFAULT_URL='{evidence.url}'",),
        )


def _has_mpudpm(process: LcmProcess) -> bool:
    return "=mpudpm:" in process.variable


@rule(
    "ttl", Severity.WARNING, "write ?ttl=1 into the URL of who should be heard by other computers"
)
def datagrams_go_as_far_as_they_should(evidence: Evidence) -> Iterator[Finding]:
    """What is sent reaches the computers that are there, and no others.

    With ttl=0 datagrams stay on the computer, with 1 in its network; more lets them go further.
    """
    others = sorted({s.sender.address for s in evidence.senders if not s.is_local})
    kept = [s for s in evidence.senders if s.is_local and s.ttl == 0]
    if others and kept:
        yield Finding(
            "ttl",
            Severity.WARNING,
            f"Other computers ({', '.join(others)}) cannot hear the following (ttl=0):",
            tuple(dict.fromkeys(f" * {sender.name}" for sender in kept)),
            (
                "start them with ?ttl=1 in the URL, for example: "
                + evidence.url.partition("?")[0]
                + "?ttl=1",
            ),
        )
    far = [s for s in evidence.senders if s.is_local and (s.ttl or 0) > 1]
    if far:
        yield Finding(
            "ttl",
            Severity.WARNING,
            "The following let routers pass their messages on to other networks:",
            tuple(dict.fromkeys(f" * {sender.name} sends with ttl={sender.ttl}" for sender in far)),
            ("ttl=1 is enough for the computers of one network",),
        )


@rule("other-users", Severity.WARNING, "choose a domain of your own: export LCMTOOLS_DOMAIN=N")
def the_bus_is_ones_own(evidence: Evidence) -> Iterator[Finding]:
    """Nobody else of this computer uses the bus.

    ttl=0 keeps messages on the computer, but not from its other users. Programs of root count as
    part of the system.
    """
    own = {evidence.host.uid, 0}
    programs: dict[int, dict[str, None]] = {}
    for uid, name in (
        *((listener.uid, listener.name) for listener in evidence.listeners),
        *((sender.uid, sender.name) for sender in evidence.senders),
    ):
        if uid is not None and uid not in own:
            programs.setdefault(uid, {})[name] = None
    if programs:
        yield Finding(
            "other-users",
            Severity.WARNING,
            "Other users of this computer share this bus:",
            tuple(
                f" * {evidence.users.get(uid, uid)}: {', '.join(names)}"
                for uid, names in sorted(programs.items())
            ),
            ("use a bus of your own: export LCMTOOLS_DOMAIN=1 (or another number up to 232)",),
        )
