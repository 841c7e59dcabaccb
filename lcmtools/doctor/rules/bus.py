"""Rules about the bus itself."""

from collections.abc import Iterator

from lcmtools.bus.url import DEFAULT_GROUP, DEFAULT_PORT, parse_url
from lcmtools.doctor.evidence import Evidence, Host, LcmProcess, sender_names
from lcmtools.doctor.findings import (
    Finding,
    Severity,
    Statement,
    Subject,
    finding,
    rule,
    state,
    subject,
)
from lcmtools.doctor.rules.connections import (
    MAY_PUBLISH,
    missed_on_other_buses,
    missed_topics,
    quiet_programs,
)
from lcmtools.doctor.rules.shared import HOST_NETWORK, MEND_BUS, MORE, PROGRAM
from lcmtools.errors import LcmtoolsError
from lcmtools.graph.model import Role
from lcmtools.names import is_hidden

_MOST, _MOST_REMEDIES = 8, 3  # programs and remedies that are shown
_MPUDPM = "=mpudpm:"  # in the variable of a process
_DEFAULT = f"{DEFAULT_GROUP}:{DEFAULT_PORT}"
_DEFAULT_URL = f"udpm://{_DEFAULT}"


@rule(
    "bus",
    remedy="lcmtools wtf prints the command that fixes the route or the firewall",
    severity=Severity.ERROR,
    title="The bus does not work: {problem}",
    facts={
        "firewall-enabled": "the firewall {firewall} is enabled",
        "in-container": "this is a {container}, which may not forward multicast",
        "interface-down": "the interface {interface} is down",
        "no-link": "the interface {interface} has no link",
        "no-multicast-flag": "the interface {interface} has no multicast flag",
    },
    remedies=HOST_NETWORK | MEND_BUS,
    evidence="a datagram that wtf sends to itself; the route, the interface's flags",
)
def bus_works(evidence: Evidence) -> Iterator[Finding]:
    """The bus can be reached: there is a route to the group, and what is sent comes back.

    Without either, LCM programs freeze for ten seconds when they start, or receive nothing.
    """
    if not evidence.bus_problem:
        return
    # facts about multicast do not apply to a server
    host = evidence.host if "udpm://" in evidence.url else Host()
    remedies = [state("mend-bus", hint=evidence.bus_remedy)] if evidence.bus_remedy else []
    if host.container == "container" and host.interface:
        remedies.append(state("host-network"))
    title = state("bus", problem=evidence.bus_problem)
    yield from finding(title, list(_obstacles(host)) or None, *remedies)


def _obstacles(host: Host) -> Iterator[Statement]:
    if not host.is_up:
        yield state("interface-down", interface=host.interface or "lo")
    if host.is_up and not host.has_link:
        yield state("no-link", interface=host.interface)
    if host.interface and not host.can_multicast:
        yield state("no-multicast-flag", interface=host.interface)
    if host.firewall:
        yield state("firewall-enabled", firewall=host.firewall)
    if host.container and host.interface:
        yield state("in-container", container=host.container)


@rule(
    "no-traffic",
    remedy="start a node, or choose the bus it is on: --lcm-url, --domain",
    title="There are no nodes on {bus}, and nothing came in {listened:g} s",
    facts={**MAY_PUBLISH, "listens": "{listener} listens"},
    remedies={
        "compare-buses": "if it runs already, it may be on another bus: compare LCM_DEFAULT_URL"
        " and LCMTOOLS_DOMAIN in both shells",
        "start-something": "start something, for example: `lcmtools run talker`",
    },
    unless={"other-buses": "", "silent": "", "stuck-listeners": "", "loss": "", "malformed": ""},
    evidence="the nodes' announcements and all messages of the look",
)
def something_is_there(evidence: Evidence) -> Iterator[Finding]:
    """There is a node or a message on the bus. If there is none, it may be the wrong bus.

    A note if plain LCM programs are present: they may have nothing to send.
    """
    if evidence.bus_problem or not is_empty(evidence):
        return
    there = dict.fromkeys(subject(one) for one in evidence.listeners if not one.is_tool)
    facts = [state("listens", listener=one) for one in there]
    facts += [state("may-publish", process=one) for one in quiet_programs(evidence)]
    severity = Severity.NOTE if facts else Severity.WARNING
    title = state("no-traffic", bus=Subject("bus", evidence.url), listened=evidence.listened)
    remedies = "start-something", "compare-buses"
    yield from finding(title, facts or None, *remedies, severity=severity)


@rule(
    "malformed",
    remedy="let the program send to another port, or choose another bus",
    title="The following senders put datagrams on the bus that are not LCM's:",
    facts={"sender-reason": "{sender}: {reason}"},
    remedies={
        "send-elsewhere": "let them send elsewhere, or end them; their ports and programs:"
        " `ss -uanp`",
    },
    evidence="all datagrams on the bus's port",
    root_only="the sender's name, if it is another user's program",
)
def datagrams_are_lcm(evidence: Evidence) -> Iterator[Finding]:
    """All datagrams on the bus are LCM's.

    Other programs' datagrams on its port can crash programs of the lcm package.
    """
    facts = (state("sender-reason", sender=who, reason=why) for who, why in evidence.malformed)
    return finding("malformed", facts, "send-elsewhere")


@rule(
    "other-buses",
    remedy="export LCM_DEFAULT_URL with the same value in every shell",
    title="The following programs of yours are on other buses{topics:with}{awaited:wait}:",
    facts={
        "on-bus": "pid {process.pid} on {bus}{variable:brackets}: {process}",
        "on-no-bus": "pid {process.pid} on no bus{variable:brackets}: {process}; {fault}",
        "on-bus-by-code": "pid {process.pid} probably on {bus} (its code names it): {process}",
        **MORE,
    },
    remedies={
        "export": "`export {variable}='{value}'`",
        "join-here": "if they should be on this one, start them with {variable}='{value}'",
        "name-here": "those without a variable get their bus from their code or arguments: name"
        " this bus there, or none: lcm.LCM()",
    },
    evidence="UDP sockets, environment variables, arguments, libraries and code of your programs;"
    " nodes and messages on up to three other buses",
    root_only="other users' programs",
)
def programs_are_on_this_bus(evidence: Evidence) -> Iterator[Finding]:
    """Programs of this user are on the bus that wtf examines.

    Programs on other buses are a note, or a warning if this bus is empty or if a topic that a
    subscription here lacks is published there, or the other way round. So is a program with a wrong
    URL if a subscription here lacks its topic: the program may be its publisher.
    """
    if evidence.bus_problem:
        return
    missed, nothing_here = missed_on_other_buses(evidence), is_empty(evidence)
    lacks = bool(missed_topics(evidence))
    elsewhere = [p for p in evidence.processes if p.bus and not _has_mpudpm(p, evidence)]
    others = [
        p
        for p in elsewhere
        if nothing_here or missed & set(p.topics) or p.awaited or (lacks and _url_fault(p))
    ]
    severity = Severity.WARNING if others else Severity.NOTE
    others = others or elsewhere
    if not others:
        return
    facts = list(map(_place, others[:_MOST]))
    if len(others) > _MOST:
        facts.append(state("more", count=len(others) - _MOST))
    urls = dict.fromkeys(_url(p) for p in others if not _url_fault(p))
    topics = sorted(missed & {topic for p in others for topic in p.topics})
    awaited = sorted({topic for p in others for topic in p.awaited})
    remedies = []
    if urls and len(urls) <= (_MOST_REMEDIES if nothing_here else bool(topics)):
        remedies += [state("export", variable="LCM_DEFAULT_URL", value=url) for url in urls]
    if not nothing_here:
        remedies.append(state("join-here", variable="LCM_DEFAULT_URL", value=evidence.url))
        if not all(p.variable for p in others):
            remedies.append(state("name-here"))
    title = state("other-buses", topics=topics, awaited=awaited)
    yield from finding(title, facts, *remedies, severity=severity)


def _place(process: LcmProcess) -> Statement:
    """Return the fact that tells the bus of a program."""
    if process.is_guess:
        return state("on-bus-by-code", process=process, bus=process.bus)
    variable = process.variable
    if fault := _url_fault(process):
        return state("on-no-bus", process=process, variable=variable, fault=fault)
    return state("on-bus", process=process, variable=variable, bus=process.bus)


def _url_fault(process: LcmProcess) -> str:
    """Return the reason why a program's URL names no bus; "" if it does."""
    try:
        parse_url(process.bus if "://" in process.bus else _DEFAULT_URL, "its URL")
    except LcmtoolsError as error:
        return error.what
    return ""


def _url(process: LcmProcess) -> str:
    if _MPUDPM in process.variable:
        return process.variable.partition("=")[2]
    return process.bus if "://" in process.bus else f"udpm://{process.bus}?ttl=0"


def is_empty(evidence: Evidence) -> bool:
    """Return whether the bus has neither nodes nor messages."""
    seen = any(not is_hidden(traffic.channel) for traffic in evidence.graph.traffic)
    nodes = any(not node.tool or node.having(Role.PUBLISHER) for node in evidence.graph.nodes)
    return not seen and not nodes


@rule(
    "mpudpm",
    remedy="give all programs the same kind of URL, udpm:// or mpudpm://",
    title="The following programs use mpudpm, which is not the udpm of this bus:",
    facts=PROGRAM,
    remedies={"start-with-variable": "start them with {variable}='{value}'"},
    evidence="mpudpm's own channels; environment variables of your programs",
    root_only="silent programs of other users",
)
def one_provider_is_used(evidence: Evidence) -> Iterator[Finding]:
    """All programs use the same kind of bus.

    mpudpm spreads channels over many ports; a udpm program receives only those on its own.
    """
    if not evidence.url.startswith("udpm"):
        return
    names = sender_names(evidence)
    internal = [t.sender for t in evidence.graph.traffic if t.channel.startswith("#!mpudpm")]
    programs = {Subject("sender", names.get(sender, str(sender))) for sender in internal if sender}
    # a program that only sends is not visible on this bus, but its variables are
    silent = [p for p in evidence.processes if _has_mpudpm(p, evidence)]
    programs |= {Subject("process", f"{p.command} (pid {p.pid})", p.pid) for p in silent}
    facts = (state("program", program=one) for one in sorted(programs, key=str))
    remedy = state("start-with-variable", variable="LCM_DEFAULT_URL", value=evidence.url)
    yield from finding("mpudpm", facts, remedy)


def _has_mpudpm(process: LcmProcess, evidence: Evidence) -> bool:
    """Return whether a process uses mpudpm on the group and port of this bus."""
    urls = process.variable.partition("=")[2], evidence.url
    place, own = (url.partition("://")[2].partition("?")[0] or _DEFAULT for url in urls)
    return _MPUDPM in process.variable and place == own


@rule(
    "ttl",
    remedy="write ?ttl=1 into the URL of programs that other computers should see",
    title={
        "ttl-0": "Other computers ({hosts:list}) cannot receive from the following (ttl=0):",
        "ttl-far": "The following let routers forward their messages to other networks:",
    },
    facts={**PROGRAM, "sends-with-ttl": "{sender} sends with ttl={ttl}"},
    remedies={
        "ttl-1-is-enough": "ttl=1 is enough for the computers of one network",
        "use-ttl-1": "start them with ?ttl=1 in the URL, for example: {url}",
    },
    evidence="the ttl of each datagram, and the addresses of senders",
)
def datagrams_go_as_far_as_they_should(evidence: Evidence) -> Iterator[Finding]:
    """Messages reach the other computers of this network, and no other networks.

    With ttl=0 datagrams stay on the computer, with 1 in its network; a higher ttl lets them go
    further. Some programs keep messages that only this computer needs local: that is a fault only
    if a node on another computer subscribes to them. If all programs of this computer do so, it is
    a note.
    """
    own = dict.fromkeys((s.name, s.ttl) for s in evidence.senders if s.is_local)
    if others := sorted({s.sender.address for s in evidence.senders if not s.is_local}):
        wanted = _subscribed_elsewhere(evidence)
        at_home = [name for name, ttl in own if ttl == 0]
        missed = [name for name in at_home if name in wanted]
        title = state("ttl-0", hosts=others)
        remedy = state("use-ttl-1", url=evidence.url.partition("?")[0] + "?ttl=1")
        yield from finding(title, (state("program", program=name) for name in missed), remedy)
        if not missed and len(at_home) == len(own):
            facts = (state("program", program=name) for name in at_home)
            yield from finding(title, facts, remedy, severity=Severity.NOTE)
    far = (state("sends-with-ttl", sender=name, ttl=ttl) for name, ttl in own if ttl and ttl > 1)
    yield from finding("ttl-far", far, "ttl-1-is-enough")


def _subscribed_elsewhere(evidence: Evidence) -> set[str]:
    nodes = evidence.graph.nodes
    far = [node for node in nodes if node.id in evidence.remote and not node.stale]
    topics = {end.topic for node in far for end in node.having(Role.SUBSCRIBER)}
    sent = {(s.name, s.channel) for s in evidence.streams}
    sent |= {(node.name, end.topic) for node in nodes for end in node.having(Role.PUBLISHER)}
    return {name for name, topic in sent if topic in topics and not is_hidden(topic)}


@rule(
    "other-users",
    remedy="choose a domain of your own: export LCMTOOLS_DOMAIN=N",
    title="Other users of this computer share this bus:",
    facts={"user-programs": "{user}: {programs:list}"},
    remedies={
        "own-domain": "use a bus of your own: `export {variable}={value}` (a number up to 232)",
    },
    evidence="the owners of the sockets of the bus",
    root_only="their programs' names",
)
def the_bus_is_ones_own(evidence: Evidence) -> Iterator[Finding]:
    """No other user of this computer uses the bus.

    ttl=0 keeps messages on the computer, but not from its other users. Programs of root count as
    part of the system.
    """
    own = {evidence.host.uid, 0}
    programs: dict[int, dict[Subject, None]] = {}
    for uid, program in (
        *((listener.uid, subject(listener)) for listener in evidence.listeners),
        *((sender.uid, Subject("sender", sender.name)) for sender in evidence.senders),
    ):
        if uid is not None and uid not in own:
            programs.setdefault(uid, {})[program] = None
    facts = (
        state("user-programs", user=evidence.users.get(uid, str(uid)), programs=found)
        for uid, found in sorted(programs.items())
    )
    return finding("other-users", facts, state("own-domain", variable="LCMTOOLS_DOMAIN", value="1"))
