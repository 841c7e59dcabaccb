"""The sockets of this computer that receive from a bus, by the socket table.

Linux only (/proc). Which channels a program listens to does not show, and programs of other users
and computers do not show at all.
"""

import time
from collections.abc import Callable, Collection

from lcmtools.bus.kernel import announced_sockets
from lcmtools.bus.processes import Process, owners, udp_sockets
from lcmtools.bus.url import BusUrl

_LOOK_PERIOD = 1.0  # [s] between two looks at the socket table
_SECOND_LOOK = 0.5
"""[s] A node's socket is a stranger's before it has announced itself and after it has said goodbye;
what is still there after so long is no node's."""
_SECOND_LOOK_AT_MARKS = 0.05  # [s]: sockets that are marked are so from their first moment


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
    """True if programs that never announce what they hear can be listening to a bus.

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
        self._strangers: frozenset[int] = frozenset()
        self._sockets: frozenset[int] = frozenset()
        self._holders: dict[int, Process] = {}

    def possible(self, *, at_once: bool = False) -> bool:
        """Return whether there can be any, as of a second ago.

        Always, where datagrams leave this computer or listeners cannot be known; never within
        one process.

        Args:
            at_once: As of now. Where sockets cannot be told apart, a socket seen for the first time
                counts too, though it may turn out to be a node that has not announced itself yet.
        """
        if self._url.provider == "memq":
            return False
        if not self._url.is_multicast or self._url.ttl:
            return True
        if at_once or self._now() >= self._next_look:
            self._look()
        return self._possible or (at_once and bool(self._strangers))

    def _look(self) -> None:
        """Look at the socket table again; strangers count when they are seen the second time.

        The tables are read one after the other, and a socket may come or go between.
        """
        before, sockets = self._strangers, listening_sockets(self._url)
        marked = announced_sockets() & sockets
        self._strangers = sockets - marked if marked else self._without_nodes(sockets)
        certain = bool(self._strangers & before)
        # Not even one's own socket is there: this system does not tell. And who was here before
        # the first look may listen from the first message on.
        self._possible = not sockets or certain or (self._possible and bool(self._strangers))
        is_sure = self._strangers <= before
        again = _SECOND_LOOK_AT_MARKS if marked else _SECOND_LOOK
        self._next_look = self._now() + (_LOOK_PERIOD if is_sure else again)

    def _without_nodes(self, sockets: frozenset[int]) -> frozenset[int]:
        """Those that belong to a process that is no node, or that is hidden.

        For systems that do not show marks: a program that is both a node and a plain one counts as
        a node here.
        """
        if sockets != self._sockets:  # to find whose they are costs milliseconds
            self._sockets, self._holders = sockets, owners(sockets)
        nodes, holders = self._nodes(), self._holders
        return frozenset(s for s in sockets if s not in holders or holders[s].pid not in nodes)
