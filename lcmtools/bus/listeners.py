"""The sockets of this computer that receive from a bus, found in the socket table.

The table shows neither a program's channels nor programs on other computers. Without a table there
may always be a listener.
"""

import time
from collections.abc import Callable

from lcmtools.bus.kernel import OWN_MARKS, marked_sockets
from lcmtools.bus.processes import Process, owners, udp_sockets
from lcmtools.bus.url import BusUrl

_READ_PERIOD = 1.0  # [s] between two readings of the socket table
_SECOND_READING = 0.05  # [s]: sockets are marked from their first moment


def listening_sockets(url: BusUrl) -> frozenset[int]:
    """Return the inodes of the sockets of this computer that receive from a multicast bus."""
    if not url.is_multicast:
        return frozenset()
    addresses = ("0.0.0.0", url.host)  # noqa: S104 - a comparison
    rows = (row for row in udp_sockets() if row.port == url.port)
    return frozenset(row.inode for row in rows if row.address in addresses)


def listening_processes(sockets: frozenset[int]) -> frozenset[Process]:
    """Return the processes that hold these sockets, of those that this user may inspect."""
    return frozenset(owners(sockets).values())


class PlainListeners:
    """The programs that listen to a bus without announcing subscriptions: unmarked sockets.

    On a system that shows no marks there may always be one.
    """

    def __init__(self, url: BusUrl, now: Callable[[], float] = time.monotonic) -> None:
        self._url = url
        self._now = now
        self._next_reading = now()
        self._possible = True
        self._foreign: frozenset[int] = frozenset()

    def possible(self, *, at_once: bool = False) -> bool:
        """Return whether there may be any, as of at most a second ago.

        Always True if datagrams leave this computer or listeners cannot be known; False within a
        single process. ``at_once`` means as of now: one seen for the first time counts too.
        """
        if self._url.provider == "memq":
            return False
        if not self._url.is_multicast or self._url.ttl:
            return True
        if at_once or self._now() >= self._next_reading:
            self._read()
        return self._possible or (at_once and bool(self._foreign))

    def _read(self) -> None:
        """Read the socket table again; a foreign socket counts once it has been seen twice.

        The tables are read one after the other, and sockets may appear or disappear in between.
        """
        before, sockets = self._foreign, listening_sockets(self._url)
        self._foreign = sockets - marked_sockets(*OWN_MARKS)
        certain = bool(self._foreign & before)
        # If even this process's socket is missing, the system shows none. And a program that was
        # here before the first reading may have listened from the first message on.
        self._possible = not sockets or certain or (self._possible and bool(self._foreign))
        is_sure = self._foreign <= before
        self._next_reading = self._now() + (_READ_PERIOD if is_sure else _SECOND_READING)
