"""Who listens to a bus on this computer, as far as the socket table shows it.

Linux only (/proc). Which channels a program listens to does not show, and programs of other users
and computers do not show at all.
"""

import time
from collections.abc import Callable, Collection

from lcmtools.bus.processes import Process, owners, udp_sockets
from lcmtools.bus.url import BusUrl

_LOOK_PERIOD = 1.0  # [s] between two looks at the socket table


def listening_sockets(url: BusUrl) -> frozenset[int]:
    """The inodes of the sockets of this computer that receive what is sent on a multicast bus."""
    if not url.is_multicast:
        return frozenset()
    addresses = ("0.0.0.0", url.host)  # noqa: S104 - a comparison
    return frozenset(
        row.inode for row in udp_sockets() if row.port == url.port and row.address in addresses
    )


def listening_processes(sockets: frozenset[int]) -> frozenset[Process]:
    """The processes that hold these sockets, those that this user may look into."""
    return frozenset(owners(sockets).values())


class PlainListeners:
    """Whether programs that never announce what they hear can be listening to a bus.

    Args:
        url: The bus.
        nodes: The numbers of the processes that announce what they hear, on this computer.
        now: A monotonic clock [s].
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
        self._next_look = now()
        self._possible = True
        self._sockets: frozenset[int] = frozenset()
        self._holders: dict[int, Process] = {}

    def possible(self) -> bool:
        """Whether there can be any, as of a second ago.

        Always, where datagrams leave this computer or nobody can know who listens; never within
        one process.
        """
        if self._url.provider == "memq":
            return False
        if not self._url.is_multicast or self._url.ttl:
            return True
        if self._now() >= self._next_look:
            self._next_look = self._now() + _LOOK_PERIOD
            self._possible = self._look()
        return self._possible

    def _look(self) -> bool:
        """Whether a socket of the bus belongs to a process that is no node, or that is hidden."""
        sockets = listening_sockets(self._url)
        if sockets != self._sockets:  # to find whose they are costs milliseconds
            self._sockets, self._holders = sockets, owners(sockets)
        nodes = self._nodes()
        return not sockets or any(  # not even one's own: this system does not tell
            inode not in self._holders or self._holders[inode].pid not in nodes for inode in sockets
        )
