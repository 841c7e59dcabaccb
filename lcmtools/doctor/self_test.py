"""Messages that wtf sends to itself, to test whether they can be sent and received.

Belongs here: the sockets of these tests. Programs on the bus receive only LCM's usual self test:
the large message goes to a free port, with ttl 0.
"""

import errno
import select
import socket

from lcmtools.bus.multicast import (
    check_multicast,
    check_route,
    check_sending,
    receiving_socket,
    sending_socket,
)
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.wire.datagram import fragments

LARGE_BYTES = 300_000  # the size of the large message: five datagrams, as an image
_CHANNEL = "/_lcmtools/self_test"
_TIMEOUT = 0.5  # [s] for one datagram, which takes well under a millisecond
_LARGEST_DATAGRAM = 65_535  # bytes


def large_problem(url: BusUrl) -> str:
    """Return the reason why a large message does not come back to this computer; "" if it does.

    Each datagram is read before the next one is sent, so that the size of the buffer
    does not matter.
    """
    try:
        check_route(url)
        check_multicast(url)
    except BusError:
        return ""  # not even a small one does, which is another fault
    try:
        free_port = url._replace(port=0)
        with receiving_socket(free_port, is_brief=True) as receiver, sending_socket(url) as sender:
            sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
            address = (url.host, receiver.getsockname()[1])
            parts = list(fragments(0, _CHANNEL, bytes(LARGE_BYTES)))
            for number, part in enumerate(parts, start=1):
                sender.sendto(part, address)
                has_come = select.select([receiver], [], [], _TIMEOUT)[0]
                if not has_come or receiver.recv(_LARGEST_DATAGRAM) != part:
                    return f"part {number} of {len(parts)}, {len(part)} bytes, is lost"
    except BusError as error:
        return error.what
    except OSError as error:
        if error.errno == errno.EMSGSIZE:
            return "the system does not send datagrams as large as LCM's"
        return f"{error.strerror}"
    return ""


def send_problem(url: BusUrl) -> tuple[str, str]:
    """Return the reason why nothing can be sent with the bus's ttl, and a remedy; else ""."""
    try:
        check_sending(url)
    except BusError as error:
        return error.what, error.hint
    return "", ""
