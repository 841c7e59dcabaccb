"""Keeping malformed datagrams from liblcm, which can crash on them.

liblcm trusts its input: a datagram that ends within its channel's name makes it read what another
message left in the same buffer, and the process may die. On Linux ``socket_filter.well_formed``
drops such datagrams before they are queued; elsewhere liblcm is unprotected.
"""

import contextlib
import os
import socket
import stat
from pathlib import Path

from lcmtools.bus.kernel import ANNOUNCED, mark
from lcmtools.bus.socket_filter import attach, well_formed
from lcmtools.bus.url import BusUrl


def protect(url: BusUrl, known: set[int]) -> None:
    """Attach the filter to the sockets of this process that listen to the bus, and mark them.

    Args:
        url: A multicast bus.
        known: File descriptors that are not liblcm's and stay as they are.
    """
    program = well_formed()
    for descriptor in filter(_is_socket, open_descriptors() - known):
        # a duplicate, because closing the Python object must not close liblcm's socket
        with socket.socket(fileno=os.dup(descriptor)) as listener, contextlib.suppress(OSError):
            if listener.getsockname() == (url.host, url.port):
                attach(listener, program)
                mark(listener, ANNOUNCED)


def open_descriptors() -> set[int]:
    """The file descriptors of this process; empty where the system does not show them."""
    try:
        return {int(entry.name) for entry in Path("/proc/self/fd").iterdir()}
    except OSError:
        return set()


def _is_socket(descriptor: int) -> bool:
    try:
        return stat.S_ISSOCK(os.fstat(descriptor).st_mode)
    except OSError:  # closed meanwhile
        return False
