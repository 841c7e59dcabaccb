"""Datagrams that full receive buffers dropped, by the kernel's counters.

A socket's counter includes the datagrams that its filter drops. The system's counter has only the
drops of full buffers, of all sockets.
"""

from collections.abc import Collection, Mapping

from lcmtools.bus.processes import UdpSocket

_BEHIND = 0.5  # share of its buffer that is full if a program reads too slowly


class BufferDrops:
    """The drops between two readings of the table of sockets by inode.

    ``filtered`` sockets have a filter that drops on purpose. ``overflows`` are the drops of full
    buffers of all sockets between the two readings.
    """

    def __init__(
        self,
        before: Mapping[int, UdpSocket],
        after: Mapping[int, UdpSocket],
        filtered: Collection[int],
        overflows: int,
    ) -> None:
        self._before, self._after, self._filtered = before, after, filtered
        others = sum(self._counted(one) for one in after if one not in filtered)
        self._unexplained = max(0, overflows - others)

    def of(self, inode: int, buffer_bytes: int | None) -> int:
        """Return a socket's dropped datagrams. For a filtered socket this is an upper bound."""
        counted = self._counted(inode)
        if inode not in self._filtered:
            return counted
        rows = [row for table in (self._before, self._after) if (row := table.get(inode))]
        queued = max((row.queued_bytes for row in rows), default=0)
        is_behind = bool(buffer_bytes) and queued >= _BEHIND * (buffer_bytes or 0)
        return min(counted, self._unexplained) if is_behind else 0

    def _counted(self, inode: int) -> int:
        was, now = self._before.get(inode), self._after.get(inode)
        return max(0, now.drops - was.drops) if was and now else 0
