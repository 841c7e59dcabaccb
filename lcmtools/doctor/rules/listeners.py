"""Rules about who receives on this computer, and about the computer."""

from collections.abc import Iterator

from lcmtools.doctor.model import Evidence, Finding, Listener, Severity, Stream, rule

_PER_MESSAGE = 1.1  # a buffer of this many times a message takes it
_DATAGRAM = 65_507  # bytes at most
_STOPPED = frozenset({"T", "t"})


@rule(
    "kernel-drops",
    Severity.WARNING,
    "recv_buf_size=N in its URL; sudo sysctl -w net.core.rmem_max=8388608",
)
def buffers_have_room(evidence: Evidence) -> Iterator[Finding]:
    """The kernel drops nothing that a program of this computer should receive.

    It does where a program does not read fast enough, or a burst is larger than its buffer.
    """
    small = _too_small(evidence)  # said by another rule
    slow = [
        x
        for x in _others(evidence)
        if x.drops
        and x not in small
        and not _is_stuck(x)
        and not (x.is_node and evidence.malformed)
    ]
    if slow:
        yield Finding(
            "kernel-drops",
            Severity.WARNING,
            "The kernel dropped datagrams that the following did not read in time:",
            tuple(f" * {x.name}: {x.drops}, its buffer {_size(x)}" for x in slow),
            _buffer_remedies(evidence),
        )


@rule("stuck-listeners", Severity.WARNING, "wake it: kill -CONT PID; or end it: kill PID")
def listeners_read(evidence: Evidence) -> Iterator[Finding]:
    """Who has subscribed reads what comes. A stopped program does not, and its buffer fills."""
    stale = {node.pid for node in evidence.own_nodes() if node.stale}  # said by another rule
    stuck = [x for x in _others(evidence) if x.pid not in stale and _is_stuck(x)]
    if stuck:
        yield Finding(
            "stuck-listeners",
            Severity.WARNING,
            "The following listen, but do not read:",
            tuple(
                f" * {x.name}: "
                + ("it is stopped" if x.state in _STOPPED else f"{x.queued_bytes} bytes wait")
                for x in stuck
            ),
            tuple(
                f"wake it (kill -CONT {x.pid}) or end it (kill {x.pid})"
                if x.state in _STOPPED
                else f"see what it does: sudo py-spy dump --pid {x.pid}, or gdb -p {x.pid}"
                for x in stuck
                if x.pid
            ),
        )


@rule(
    "small-buffer",
    Severity.WARNING,
    "recv_buf_size=N in its URL; sudo sysctl -w net.core.rmem_max=8388608",
)
def messages_fit_buffers(evidence: Evidence) -> Iterator[Finding]:
    """Every listener's buffer takes the largest message that comes.

    liblcm sends all parts of a large message at once; nodes of lcmtools spread them, which needs no
    large buffer.
    """
    largest, small = _largest(evidence), _too_small(evidence)
    if largest and small:
        yield Finding(
            "small-buffer",
            Severity.WARNING,
            f"{largest.channel} from {largest.name} has {largest.largest} bytes, too many for:",
            tuple(f" * {x.name}: {_size(x)}" for x in small),
            _buffer_remedies(evidence, 2 * largest.largest),
        )


@rule(
    "interfaces",
    Severity.WARNING,
    "restart the listeners, or pin the route: ip route add 224.0.0.0/4 dev X",
)
def the_group_is_joined_where_the_route_leads(evidence: Evidence) -> Iterator[Finding]:
    """Who listens does so on the interface that messages leave by.

    A program joins the group where the route led when it started, and stays there when the route
    changes.
    """
    host = evidence.host
    others = [name for name in host.joined if name != host.interface]
    if host.interface and others and evidence.listeners:
        yield Finding(
            "interfaces",
            Severity.WARNING,
            f"The route to the bus leads to {host.interface}, but somebody listens elsewhere:",
            tuple(f" * on {name}" for name in others),
            ("start the listeners again, or let the route lead there: ip route show 224.0.0.0/4",),
        )


@rule(
    "reassembly",
    Severity.WARNING,
    "smaller messages (below 1400 bytes none is cut), or a wired network",
)
def datagrams_arrive_complete(evidence: Evidence) -> Iterator[Finding]:
    """Datagrams that the network has cut into pieces arrive with all of them.

    One lost piece loses the datagram, and with it the message.
    """
    failed = evidence.host.reassembly_failures
    if failed:
        text = f"{failed} datagrams came without some of their pieces"
        yield Finding("reassembly", Severity.WARNING, text, (), ("send smaller messages",))


@rule("rp-filter", Severity.NOTE, "sudo sysctl -w net.ipv4.conf.all.rp_filter=2")
def strict_filters_are_off(evidence: Evidence) -> Iterator[Finding]:
    """The kernel does not drop messages of computers to which another interface leads.

    It does where rp_filter is strict, which matters on computers with several interfaces.
    """
    if evidence.ttl and evidence.host.rp_filter == 1 and evidence.host.others:
        where = evidence.host.interface or "all interfaces"
        text = f"rp_filter is strict on {where}: it may drop other computers' messages"
        yield Finding(
            "rp-filter", Severity.NOTE, text, (), ("sudo sysctl -w net.ipv4.conf.all.rp_filter=2",)
        )


@rule("firewall", Severity.NOTE, "sudo ufw allow in proto udp to 224.0.0.0/4")
def no_firewall_is_in_the_way(evidence: Evidence) -> Iterator[Finding]:
    """A firewall lets the bus's datagrams pass, where other computers should be heard."""
    remote = any(not s.is_local for s in evidence.senders)
    if evidence.ttl and evidence.host.firewall and not remote:
        text = f"The firewall {evidence.host.firewall} is enabled, and no other computer is heard"
        yield Finding(
            "firewall", Severity.NOTE, text, (), ("sudo ufw allow in proto udp to 224.0.0.0/4",)
        )


@rule("environment", Severity.WARNING, "correct the variable, or pip install lcm")
def the_environment_is_in_order(evidence: Evidence) -> Iterator[Finding]:
    """Variables name what exists, and Python finds LCM's package and no other."""
    if evidence.host.environment:
        yield Finding(
            "environment",
            Severity.WARNING,
            "The environment of this shell is not in order:",
            tuple(f" * {line}" for line in evidence.host.environment),
        )


def _others(evidence: Evidence) -> list[Listener]:
    return [listener for listener in evidence.listeners if not listener.is_tool]


def _largest(evidence: Evidence) -> Stream | None:
    """The stream with the largest messages of several datagrams that come in one burst."""
    paced = {s.sender for s in evidence.senders if s.paces}
    large = [s for s in evidence.streams if s.sender and s.sender not in paced]
    found = max(large, key=lambda stream: stream.largest, default=None)
    return found if found and found.largest > _DATAGRAM else None


def _too_small(evidence: Evidence) -> list[Listener]:
    """The listeners whose buffers cannot take the largest message."""
    largest = _largest(evidence)
    needed = _PER_MESSAGE * largest.largest if largest else 0
    return [x for x in _others(evidence) if x.buffer_bytes and x.buffer_bytes < needed]


def _is_stuck(listener: Listener) -> bool:
    if listener.state in _STOPPED:
        return True
    waits = listener.queued_bytes and listener.was_queued_bytes
    return bool(waits and listener.drops and listener.queued_bytes >= listener.was_queued_bytes)


def _size(listener: Listener) -> str:
    return f"holds {listener.buffer_bytes} bytes" if listener.buffer_bytes else "is too small"


def _buffer_remedies(evidence: Evidence, wanted: int = 4 << 20) -> tuple[str, ...]:
    separator = "&" if "?" in evidence.url else "?"
    remedies = [f"start it with LCM_DEFAULT_URL='{evidence.url}{separator}recv_buf_size={wanted}'"]
    if 0 < evidence.host.most_receive_buffer < wanted:
        remedies.append(f"sudo sysctl -w net.core.rmem_max={max(wanted, 8 << 20)}")
    return tuple(remedies)
