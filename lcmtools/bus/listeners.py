"""The sockets of this computer that receive from a bus, found in the socket table.

The table shows neither a program's channels nor programs on other computers. Without a table there
may always be a listener.
"""

import time
from collections.abc import Callable, Collection

from lcmtools.bus.kernel import OWN_MARKS, marked_sockets
from lcmtools.bus.processes import Process, owners, udp_sockets
from lcmtools.bus.url import BusUrl

_READ_PERIOD = 1.0  # [s] between two readings of the socket table
_SECOND_READING = 0.5
"""[s] A node's socket counts as foreign before its first announcement and after its goodbye; one
that is still foreign after this time does not belong to a node."""
_SECOND_READING_OF_MARKS = 0.05  # [s]: sockets are marked from their first moment


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
    """The programs that listen to a bus without announcing subscriptions.

    ``nodes`` returns the pids of the processes on this computer that announce subscriptions.
    """

    def __init__(
        self,
        url: BusUrl,
        nodes: Callable[[], Collection[int]],
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._url = url
        self._nodes = nodes
        self._now = now
        self._next_reading = now()
        self._possible = True
        self._foreign: frozenset[int] = frozenset()
        self._sockets: frozenset[int] = frozenset()
        self._holders: dict[int, Process] = {}

    def possible(self, *, at_once: bool = False) -> bool:
        """Return whether there may be any, as of at most a second ago.

        Always True if datagrams leave this computer or listeners cannot be known; False within a
        single process. ``at_once`` means as of now: if sockets are not marked, one seen for the
        first time counts too, though it may be of a node that has not announced itself yet.
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
        marked = marked_sockets(*OWN_MARKS) & sockets
        self._foreign = sockets - marked if marked else self._without_nodes(sockets)
        certain = bool(self._foreign & before)
        # If even this process's socket is missing, the system shows none. And a program that was
        # here before the first reading may have listened from the first message on.
        self._possible = not sockets or certain or (self._possible and bool(self._foreign))
        is_sure = self._foreign <= before
        again = _SECOND_READING_OF_MARKS if marked else _SECOND_READING
        self._next_reading = self._now() + (_READ_PERIOD if is_sure else again)

    def _without_nodes(self, sockets: frozenset[int]) -> frozenset[int]:
        """Return the sockets of processes that are unknown or not nodes; for systems without marks.

        A program that is both a node and a plain LCM program counts as a node here.
        """
        if sockets != self._sockets:  # finding their processes takes milliseconds
            self._sockets, self._holders = sockets, owners(sockets)
        nodes, holders = self._nodes(), self._holders
        return frozenset(s for s in sockets if s not in holders or holders[s].pid not in nodes)
