"""UDP multicast sockets as LCM uses them, and checks of whether multicast works here.

liblcm detects that multicast does not work by freezing the whole process for ten seconds; the check
here takes a millisecond if it works and under half a second if it does not.
"""

import contextlib
import errno
import socket
import struct
import time
from collections.abc import Iterator

from lcmtools.bus.kernel import (
    ANNOUNCED,
    IS_LINUX,
    SELECTIVE,
    attach,
    mark,
    receive_buffer_bytes,
    request_arrival,
    share_port,
)
from lcmtools.bus.network_watch import LOOPBACK, TOLD, join, join_loopback, network_watch
from lcmtools.bus.socket_filter import FilterProgram
from lcmtools.bus.url import BusUrl
from lcmtools.bus.wakeup import wait_readable
from lcmtools.errors import BusError, os_errors_as
from lcmtools.names import SELF_TEST_CHANNEL
from lcmtools.wire.datagram import short_message

_IP_PKTINFO = 8  # linux/in.h
_SELF_TEST = short_message(0, SELF_TEST_CHANNEL, b"lcm self test")
_LOOPBACK_ROUTE = "sudo ip link set lo up multicast on && sudo ip route add 224.0.0.0/4 dev lo"
_NETWORK_ROUTE = "sudo ip route add 224.0.0.0/4 dev IFACE"
_NO_ROUTE = {errno.ENETUNREACH, errno.ENODEV, errno.EADDRNOTAVAIL, errno.EHOSTUNREACH}
_FORBIDDING_ROUTES = {errno.EACCES: "prohibit", errno.EINVAL: "blackhole"}
_OVER_LOOPBACK = socket.IPPROTO_IP, _IP_PKTINFO, struct.pack("=i4s4s", LOOPBACK, b"", b"")
_FULL_QUEUE = (
    "the queue of the network card to {where} is full",
    "send less, or give it more room: sudo ip link set dev IFACE txqueuelen 10000",
)
_FEW_MEMBERSHIPS = (
    "the system permits no membership of {where}",
    "type: sudo sysctl -w net.ipv4.igmp_max_memberships=20 net.core.optmem_max=131072",
)
_ATTEMPTS, _ATTEMPT = 8, 0.05  # [s] for each; it normally takes well under a millisecond
_MOST_OTHERS = 1000  # datagrams of others that are read for an attempt


def sending_socket(url: BusUrl) -> socket.socket:
    """Return a socket that sends to the group as liblcm does: looped back, with the bus's ttl.

    Raises:
        BusError: The system does not limit the hops of its datagrams.
    """
    with _explained(url), contextlib.ExitStack() as stack:
        sender = stack.enter_context(_own_socket())
        with os_errors_as(f"the system does not limit datagrams to {url.ttl} hops", kind=BusError):
            sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, url.ttl)
        with contextlib.suppress(OSError):  # it is the default
            sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_LOOP, 1)
        stack.pop_all()
    return sender


def _own_socket() -> socket.socket:
    """Return a socket that blocks, whatever the program's default for new sockets."""
    found = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    found.settimeout(None)
    return found


def send_to_group(sender: socket.socket, datagram: bytes, address: tuple[str, int]) -> None:
    """Send a datagram to a group; without a route, to the programs of this computer only.

    Raises:
        OSError: The system does not send it.
    """
    try:
        sender.sendto(datagram, address)
    except OSError as error:
        if error.errno != errno.ENETUNREACH or not IS_LINUX:
            raise
        sender.sendmsg([datagram], [_OVER_LOOPBACK], 0, address)


def receiving_socket(
    url: BusUrl, program: FilterProgram | None = None, *, is_brief: bool = False
) -> socket.socket:
    """Return a socket that receives from the group shared with others, as liblcm's receivers do.

    It has ``program`` as its filter from the beginning, if the system has filters, and all its
    datagrams have their receive time, if the system gives one: one that came before the request
    would have the time of reading it. It follows the network, unless it ``is_brief``.

    Raises:
        BusError: The group cannot be joined.
    """
    with _explained(url), contextlib.ExitStack() as stack:
        receiver = stack.enter_context(_own_socket())  # closed on an error
        share_port(receiver)
        with contextlib.suppress(OSError):  # the usual buffer may do
            receiver.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer_bytes())
        request_arrival(receiver, ttl=False)
        mark(receiver, SELECTIVE if program and attach(receiver, program) else ANNOUNCED)
        # bound to the group itself, so that other groups on the same port stay out
        receiver.bind((url.host, url.port))
        if not is_brief:  # before it joins: what changes from now on is reported
            network_watch.follow(receiver, url.host)
        with _explained(url, _FEW_MEMBERSHIPS):
            try:
                join(receiver, url.host)
            except OSError as error:  # without a route, only this computer's programs are heard
                if error.errno != errno.ENODEV or not IS_LINUX:
                    raise
        join_loopback(receiver, url.host)
        stack.pop_all()
    return receiver


def check_route(url: BusUrl) -> None:
    """Make sure that there is a route to the group; raises BusError if there is none."""
    with _explained(url), _own_socket() as probe:
        probe.connect((url.host, url.port))  # sends nothing


def missing_route(url: BusUrl) -> str:
    """Return a sentence if there is no route to a bus's group; "" if there is, or no group."""
    if url.is_multicast:
        try:
            check_route(url)
        except BusError:
            return TOLD[False].format(group=url.host)
    return ""


def check_multicast(url: BusUrl) -> None:
    """Make sure that a datagram sent to the group comes back to this host.

    Raises:
        BusError: It does not; the error says what to type. This takes under half a second.
    """
    with receiving_socket(url, is_brief=True) as receiver, sending_socket(url) as sender:
        sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        check_loopback(url, sender, receiver)


def check_sending(url: BusUrl) -> None:
    """Send LCM's self test with the bus's own TTL; it need not arrive.

    Raises:
        BusError: The system does not send it.
    """
    with sending_socket(url) as sender, _explained(url):
        sender.sendto(_SELF_TEST, (url.host, url.port))


def check_loopback(url: BusUrl, sender: socket.socket, receiver: socket.socket) -> None:
    """Send LCM's self test and check that it comes back; BusError if it does not."""
    with _explained(url):
        for _ in range(_ATTEMPTS):
            send_to_group(sender, _SELF_TEST, (url.host, url.port))
            if _receives_self_test(receiver, sender.getsockname()[1]):
                return
    hint = f"a firewall or the route to the group blocks it; type: {_LOOPBACK_ROUTE}"
    raise BusError(f"multicast to {url.host}:{url.port} does not come back to this host", hint)


def _receives_self_test(receiver: socket.socket, port: int) -> bool:
    """Return whether this process's own datagram arrives; other traffic is ignored.

    What is there counts, however late a busy computer lets this process look.
    """
    deadline = time.monotonic() + _ATTEMPT
    for _ in range(_MOST_OTHERS):
        if not wait_readable([receiver.fileno()], max(0.0, deadline - time.monotonic())):
            return False
        data, address = receiver.recvfrom(len(_SELF_TEST) + 1)
        if data == _SELF_TEST and address[1] == port:
            return True
    return False


@contextlib.contextmanager
def _explained(url: BusUrl, full: tuple[str, str] = _FULL_QUEUE) -> Iterator[None]:
    """Raise a system error as a BusError, explained to a user; ``full`` explains ENOBUFS."""
    where = f"{url.host}:{url.port}"
    try:
        yield
    except OSError as error:
        what, hint = f"cannot use {where}: {error.strerror}", "lcmtools wtf shows more"
        if error.errno in _NO_ROUTE:
            what, hint = f"no multicast route to {where}", f"type: {_LOOPBACK_ROUTE}"
            if url.ttl:  # a route to lo would keep messages here, also once there is a network
                hint = f"connect the network, or set a route to its interface: {_NETWORK_ROUTE}"
        elif error.errno in _FORBIDDING_ROUTES:
            kind = _FORBIDDING_ROUTES[error.errno]
            what = f"a {kind} route forbids sending to {where} ({error.strerror})"
            show = f"ip route show table all type {kind}"
            hint = f"find it with: {show}; then: sudo ip route del LINE"
        elif error.errno == errno.EPERM:
            what = f"sending to {where} is forbidden ({error.strerror})"
            allow = f"sudo ufw allow out to {url.host} port {url.port} proto udp"
            hint = f"a firewall does that; type: {allow}"
        elif error.errno == errno.EADDRINUSE:
            what = f"{where} is used by a program that does not share it"
            hint = f"find it with: ss -ulnp 'sport = :{url.port}'"
        elif error.errno == errno.ENOBUFS:
            what, hint = full[0].format(where=where), full[1]
        raise BusError(what, hint) from error
