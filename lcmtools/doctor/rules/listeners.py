"""Rules about the programs that receive on this computer, and its settings."""

from collections.abc import Iterator

from lcmtools.doctor.evidence import Evidence, Listener, Stream
from lcmtools.doctor.findings import Finding, Severity, Statement, finding, rule, state
from lcmtools.doctor.rules.shared import WAKE_OR_END
from lcmtools.graph.model import NodeInfo

_PER_MESSAGE = 1.1  # times a message: a buffer of this size holds it
_DATAGRAM = 65_507  # bytes at most
_STOPPED = frozenset({"T", "t"})
_NEARLY_ALL, _AT_EDGES = 0.95, 2  # share of the messages of a look; messages at its ends
_FILLING = 1.2  # times the bytes that waited at its start
_BUFFER, _LARGE = 4 << 20, 8 << 20  # bytes that are enough for most; for all that is common
_BUFFERS = "net.core.rmem_max"

_SYSCTL = {"sysctl": "`sudo sysctl -w {name}={value}`"}
_LARGER_BUFFER = {**_SYSCTL, "start-it-with-variable": "start it with {variable}='{value}'"}


@rule(
    "kernel-drops",
    remedy="recv_buf_size=N in its URL; sudo sysctl -w net.core.rmem_max=8388608",
    title="The following read too slowly, so that the kernel dropped datagrams:",
    facts={"dropped": "{listener}: {drops}, its receive buffer {buffer_bytes:holds}"},
    remedies=_LARGER_BUFFER,
    unless={"stuck-listeners": "who", "small-buffer": "who"},
    evidence="the kernel's count of drops for each socket",
    root_only="the names of other users' programs",
)
def buffers_have_room(evidence: Evidence) -> Iterator[Finding]:
    """The kernel drops nothing that a program of this computer should receive.

    It does if a program does not read fast enough, or a burst is larger than its buffer.
    """
    facts = (
        state("dropped", listener=x, drops=x.drops, buffer_bytes=x.buffer_bytes or 0)
        for x in _programs(evidence)
        if x.drops and not (x.is_node and evidence.malformed)
    )
    return finding("kernel-drops", facts, *_larger_buffer(evidence))


@rule(
    "incomplete-messages",
    remedy="send smaller messages, or enlarge receive buffers: sudo sysctl -w"
    " net.core.rmem_max=8388608",
    title="The following nodes received messages incompletely:",
    facts={
        "incomplete": "{node} lost {lost} large messages of {topic}: parts of them did not arrive",
        "overflowed": "{node}: its full receive buffers dropped up to {count} datagrams",
    },
    remedies={
        "larger-buffer-there": "on the computer of {node}: `sudo sysctl -w {name}={value}`, and"
        " restart it",
        "send-smaller-on": "send fewer or smaller messages on {topic}: one is lost with any of its"
        " parts",
    },
    unless={"loss": "", "kernel-drops": "pid"},
    evidence="the counters in two announcements of each node",
)
def nodes_receive_whole_messages(evidence: Evidence) -> Iterator[Finding]:
    """Nodes receive large messages with all their parts, and their receive buffers have room.

    Nodes announce what they lost, so those of other computers are judged, too. A large message
    whose sender did not send all of it counts as lost by the sender. What the kernel of this
    computer dropped is reported with its socket.
    """
    found = list(_losses_of_nodes(evidence))
    yield from finding(
        "incomplete-messages", (fact for fact, _ in found), *(remedy for _, remedy in found)
    )


@rule(
    "stuck-listeners",
    remedy="wake it: kill -CONT PID; or end it: kill -KILL PID",
    title="The following are subscribed, but do not read:",
    facts={
        "bytes-wait": "{listener}: {queued_bytes} bytes are waiting",
        "messages-wait": "{listener}: messages are waiting, and it has handled none for"
        " {seconds:time}",
        "stopped": "{listener}: it is stopped",
    },
    remedies={
        **WAKE_OR_END,
        "inspect": "see what it does: `sudo gdb -p {pid}`",
        "inspect-java": "see what it does: `jstack {pid}`",
        "inspect-python": "see what it does: `sudo py-spy dump --pid {pid}`",
    },
    unless={"stale-nodes": "pid"},
    evidence="the bytes that wait at each socket and in liblcm, the state of processes",
    root_only="the state of other users' programs",
)
def listeners_read(evidence: Evidence) -> Iterator[Finding]:
    """Programs that have subscribed read what arrives.

    A stopped program does not, and its buffer fills. One of liblcm whose callback does not return
    still empties its buffer, but handles nothing.
    """
    stuck = [x for x in _programs(evidence) if _is_stuck(x, evidence)]
    facts, remedies = [], []
    for x in stuck:
        if x.state in _STOPPED:
            facts.append(state("stopped", listener=x, queued_bytes=x.queued_bytes))
        elif x.hangs:
            facts.append(state("messages-wait", listener=x, seconds=evidence.listened))
        else:
            facts.append(state("bytes-wait", listener=x, queued_bytes=x.queued_bytes))
        remedy = "wake-or-end" if x.state in _STOPPED else _inspect(x)
        remedies += [state(remedy, pid=x.pid).of("pid", str(x.pid))] if x.pid else []
    return finding("stuck-listeners", facts, *remedies)


@rule(
    "small-buffer",
    remedy="recv_buf_size=N in its URL; sudo sysctl -w net.core.rmem_max=8388608",
    title="{topic} from {sender} has {bytes} bytes, too many for the receive buffers of:",
    facts={"buffer": "{listener}: {buffer_bytes:holds}"},
    remedies=_LARGER_BUFFER,
    evidence="the size of each socket's buffer, the largest message",
)
def messages_fit_buffers(evidence: Evidence) -> Iterator[Finding]:
    """Every listener's buffer can hold the largest message on the bus.

    liblcm sends all parts of a large message at once; nodes of lcmtools spread them over time,
    which needs no large buffer.
    """
    if stream := _largest(evidence):
        size = stream.largest
        title = state("small-buffer", topic=stream.channel, sender=stream, bytes=size)
        small = _too_small(evidence)
        facts = (state("buffer", listener=x, buffer_bytes=x.buffer_bytes or 0) for x in small)
        # what was dropped may also have been a burst of smaller ones
        burst = _BUFFER if any(x.drops for x in small) else 0
        yield from finding(title, facts, *_larger_buffer(evidence, max(2 * size, burst)))


@rule(
    "refused-filters",
    remedy="sudo sysctl -w net.core.optmem_max=131072",
    severity=Severity.NOTE,
    title="The kernel refused the filters of the following, which receive everything and discard"
    " most of it:",
    facts={"unfiltered": "{listener}"},
    remedies=_SYSCTL,
    evidence="the marks of sockets of lcmtools, the kernel's settings",
    root_only="the names of other users' programs",
)
def filters_are_accepted(evidence: Evidence) -> Iterator[Finding]:
    """The kernel drops for each node the messages that it does not subscribe to.

    Without a filter a node hears all the same, but has to look at each message of the bus. Kernels
    before about Linux 6.7 have little memory for the filter of a node with many subscriptions.
    """
    known = {x.name: x for x in evidence.listeners if x.is_unfiltered}
    facts = (state("unfiltered", listener=x) for x in known.values())
    remedy = state("sysctl", name="net.core.optmem_max", value=131_072)
    return finding("refused-filters", facts, remedy)


@rule(
    "interfaces",
    remedy="restart the listeners, or pin the route: ip route add 224.0.0.0/4 dev X",
    title="The route to the bus leads to {interface}, but programs listen elsewhere:",
    facts={"joined-on": "on {interface}", "listens-on": "{listener}: on {interfaces:and}"},
    remedies={
        "restart-listeners": "restart the listeners, or set the route to their interface:"
        " `ip route show 224.0.0.0/4`",
    },
    evidence="the multicast groups joined on each interface, the routing table",
    root_only="which programs of other users joined where",
)
def the_group_is_joined_where_the_route_leads(evidence: Evidence) -> Iterator[Finding]:
    """Programs listen on the interface on which messages are sent.

    A program joins the group on the interface of the route when it started, and stays there when
    the route changes.
    """
    host = evidence.host
    if host.interface and evidence.listeners:
        title = state("interfaces", interface=host.interface)
        astray = [x for x in evidence.listeners if x.joined and host.interface not in x.joined]
        facts = [state("listens-on", listener=x, interfaces=x.joined) for x in astray]
        # the interfaces of some programs are unknown
        if not all(listener.joined for listener in evidence.listeners):
            named = {host.interface, "lo", *(name for x in astray for name in x.joined)}
            others = (name for name in host.joined if name not in named)
            facts += [state("joined-on", interface=name) for name in others]
        yield from finding(title, facts, "restart-listeners")


@rule(
    "reassembly",
    remedy="smaller messages (below 1400 bytes none is fragmented), or a wired network",
    title="{datagrams} datagrams came without some of their fragments",
    remedies={"smaller-messages": "send smaller messages"},
    evidence="the kernel's count of incomplete datagrams",
)
def datagrams_arrive_complete(evidence: Evidence) -> Iterator[Finding]:
    """Datagrams that the network has cut into fragments arrive with all of them.

    One lost fragment loses the datagram, and with it the message.
    """
    if failed := evidence.host.reassembly_failures:
        yield from finding(state("reassembly", datagrams=failed), None, "smaller-messages")


@rule(
    "rp-filter",
    remedy="sudo sysctl -w net.ipv4.conf.all.rp_filter=2",
    title={
        "rp-filter": "rp_filter is strict on {interface}: it may drop other computers' messages",
        "rp-filter-drops": "rp_filter dropped {datagrams} datagrams that came in on another"
        " interface than the one that leads to their senders",
    },
    remedies=_SYSCTL,
    evidence="the kernel's settings and its count of filtered datagrams",
)
def strict_filters_are_off(evidence: Evidence) -> Iterator[Finding]:
    """The kernel does not drop messages of computers behind another interface.

    It does so if rp_filter is strict, which matters on computers with several interfaces. A note as
    long as it has dropped nothing.
    """
    host = evidence.host
    remedy = state("sysctl", name="net.ipv4.conf.all.rp_filter", value=2)
    if evidence.ttl and host.rp_filter_drops:
        yield from finding(state("rp-filter-drops", datagrams=host.rp_filter_drops), None, remedy)
    elif evidence.ttl and host.rp_filter == 1 and host.others:
        title = state("rp-filter", interface=host.interface or "all interfaces")
        yield from finding(title, None, remedy, severity=Severity.NOTE)


@rule(
    "firewall",
    remedy="sudo ufw allow in proto udp to 224.0.0.0/4",
    severity=Severity.NOTE,
    title="The firewall {firewall} is enabled, and no other computer is seen",
    remedies={
        "allow-by-firewalld": "`sudo firewall-cmd --add-rich-rule='rule family=ipv4 destination"
        " address=224.0.0.0/4 accept'`",
        "allow-by-iptables": "`sudo iptables -I {chain} -d 224.0.0.0/4 -j ACCEPT`",
        "allow-by-nftables": "`sudo nft insert rule {chain} ip daddr 224.0.0.0/4 accept`",
        "allow-by-ufw": "`sudo ufw allow in proto udp to 224.0.0.0/4`",
    },
    evidence="ufw's and firewalld's files; the rules of nft or iptables",
    root_only="the rules",
)
def no_firewall_is_in_the_way(evidence: Evidence) -> Iterator[Finding]:
    """A firewall lets the bus's datagrams pass, if other computers take part."""
    if evidence.ttl and evidence.host.firewall and not evidence.has_others():
        title = state("firewall", firewall=evidence.host.firewall)
        chain = evidence.host.firewall_chain
        yield from finding(title, None, state(f"allow-by-{evidence.host.firewall}", chain=chain))


@rule(
    "environment",
    remedy="correct the variable, or pip install lcm",
    title="The environment of this shell has errors:",
    facts={"text": "{text}"},
    remedies={
        "correct-environment": "correct the variable in this shell and in ~/.bashrc; keep only one"
        " package: pip uninstall, pip install lcm",
    },
    evidence="environment variables of this shell, Python's search path",
)
def the_environment_is_in_order(evidence: Evidence) -> Iterator[Finding]:
    """Environment variables are valid, and Python finds LCM's package and no other."""
    facts = (state("text", text=fault) for fault in evidence.host.environment)
    return finding("environment", facts, "correct-environment")


def is_in_doubt(evidence: Evidence) -> bool:
    """Return whether a program may hang: some handle messages only at times."""
    return any(x.hangs for x in _programs(evidence))


def _inspect(listener: Listener) -> str:
    """Return the kind of the remedy that shows where a program waits, by its language."""
    if listener.is_node or listener.interpreter.startswith("python"):
        return "inspect-python"
    return "inspect-java" if listener.interpreter == "java" else "inspect"


def _programs(evidence: Evidence) -> list[Listener]:
    return [listener for listener in evidence.listeners if not listener.is_tool]


def _largest(evidence: Evidence) -> Stream | None:
    """Return the stream with the largest messages whose fragments come in one burst."""
    paced = {s.sender for s in evidence.senders if s.paces}
    large = [s for s in evidence.streams if s.sender and s.sender not in paced]
    found = max(large, key=lambda stream: stream.largest, default=None)
    return found if found and found.largest > _DATAGRAM else None


def _too_small(evidence: Evidence) -> list[Listener]:
    largest = _largest(evidence)
    needed = _PER_MESSAGE * largest.largest if largest else 0
    return [x for x in _programs(evidence) if x.buffer_bytes and x.buffer_bytes < needed]


def _losses_of_nodes(evidence: Evidence) -> Iterator[tuple[Statement, Statement]]:
    """Yield what nodes lost while receiving, and the remedy."""
    own = {node.id for node in evidence.own_nodes()}
    before = {node.id: node for node in evidence.before.nodes}
    for node in evidence.graph.nodes:
        was, is_own = before.get(node.id), node.id in own
        if was is None or node.tool or node.stale:
            continue
        earlier = _incomplete(was)
        for topic, count in _incomplete(node).items():
            if (lost := count - earlier.get(topic, 0)) > 0:
                fact = state("incomplete", node=node, topic=topic, lost=lost)
                yield fact, state("send-smaller-on", topic=topic)
        if not is_own and (dropped := node.overflows - was.overflows) > 0:
            fact = state("overflowed", node=node, count=dropped)
            yield fact, state("larger-buffer-there", node=node, name=_BUFFERS, value=_LARGE)


def _incomplete(node: NodeInfo) -> dict[str, int]:
    return {end.topic: end.incomplete for end in node.endpoints if end.incomplete}


def _is_stuck(listener: Listener, evidence: Evidence) -> bool:
    """Return whether a program reads nothing: a slow one does not drop everything."""
    if listener.state in _STOPPED or listener.hangs:
        return True
    before, now = listener.was_queued_bytes, listener.queued_bytes
    came = sum(sender.messages for sender in evidence.senders)
    has_read = now <= _FILLING * before and listener.drops + _AT_EDGES < _NEARLY_ALL * came
    return bool(before and listener.drops) and now >= before and not has_read


def _larger_buffer(evidence: Evidence, needed: int = _BUFFER) -> tuple[Statement, ...]:
    separator = "&" if "?" in evidence.url else "?"
    url = f"{evidence.url}{separator}recv_buf_size={needed}"
    remedies = [state("start-it-with-variable", variable="LCM_DEFAULT_URL", value=url)]
    if 0 < evidence.host.most_receive_buffer < needed:
        remedies.append(state("sysctl", name=_BUFFERS, value=max(needed, _LARGE)))
    return tuple(remedies)
