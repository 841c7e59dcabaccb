"""Evidence about computers: this one, and the others' clocks."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Host:
    """What of this computer bears on the bus; empty where the system does not tell.

    Attributes:
        uid: The user who looks.
        interface: Where the route to the group leads ("lo", "eth0").
        is_up: Whether that is up.
        can_multicast: Whether it has its multicast flag.
        joined: The interfaces on which somebody has joined the group.
        rp_filter: Of the interface: 1 is strict.
        speed_mbit: Of the interface, megabit per second.
        is_wireless: Whether it is.
        receive_buffer: What a socket gets that asks for nothing (rmem_default) [byte].
        most_receive_buffer: What one may ask for (rmem_max) [byte].
        firewall: The name of a firewall that is enabled.
        container: "container" or "WSL", where this is one.
        reassembly_failures: IP datagrams whose pieces did not all come, while wtf listened.
        environment: What is wrong with variables and Python packages, one line each.
        others: Other interfaces to which routes lead, but for lo.
        firewall_unknown: Why it is not known whether a firewall is in the way; "" where it is.
        is_virtual: The interface ends in another network of this computer, as in a container.
        bridge: The bridge that the route leads over, where it looks who listens but does not ask.
        large_bytes: How large the message was that wtf sent to itself.
        large_problem: Why that did not come back; "" when it did.
        send_problem: Why nothing can be sent with the bus's own ttl; "" where it can.
        send_remedy: What to type against that.
        has_sockets: The system tells of its sockets (/proc/net/udp).
    """

    uid: int = 0
    interface: str = ""
    is_up: bool = True
    can_multicast: bool = True
    joined: tuple[str, ...] = ()
    rp_filter: int = 0
    speed_mbit: int = 0
    is_wireless: bool = False
    receive_buffer: int = 0
    most_receive_buffer: int = 0
    firewall: str = ""
    container: str = ""
    reassembly_failures: int = 0
    environment: tuple[str, ...] = ()
    others: tuple[str, ...] = ()
    firewall_unknown: str = ""
    is_virtual: bool = False
    bridge: str = ""
    large_bytes: int = 0
    large_problem: str = ""
    send_problem: str = ""
    send_remedy: str = ""
    has_sockets: bool = True


@dataclass(frozen=True, slots=True)
class HostClock:
    """How another computer's clock compares with this one's.

    Attributes:
        host: Its name.
        address: Where its messages come from.
        lag: How long after they were sent its announcements come, at least, by the two clocks [s]:
            negative where its clock is ahead.
        nodes: The nodes that tell.
    """

    host: str
    address: str
    lag: float
    nodes: tuple[str, ...]
