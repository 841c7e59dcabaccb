"""The kernel's filter on the sockets of an LCM instance.

Without it, liblcm's thread would wake for each datagram of the bus, even for its own process's,
only to find that nobody subscribes to its channel: for a node that sends at a high rate, this is a
third of the cost of sending. On systems other than Linux there is no filter.
"""

import socket
from collections.abc import Collection, Iterable

from lcmtools.bus.kernel import ANNOUNCED, SUBSCRIBED, attach, detach, mark
from lcmtools.bus.socket_filter import ENDING_BYTES, these_channels, these_endings, well_formed

_MOST = 50  # at most that a datagram is compared with: channels, or endings of their names


class ChannelFilter:
    """Drops malformed datagrams and, from the first ``let_pass``, those of other channels.

    It is attached to the instance's receiving sockets or duplicates of them, which ``close``
    closes.
    """

    def __init__(self, sockets: Iterable[socket.socket]) -> None:
        self._sockets = list(sockets)
        for one in self._sockets:
            attach(one, well_formed())
            mark(one, ANNOUNCED)
        # if there are several, some may belong to an instance that another thread just made
        self._is_narrow = len(self._sockets) == 1
        self._endings: Collection[bytes] = ()
        """The endings of channels that pass, if the filter compares only the endings."""

    def passes(self, channel: str) -> bool:
        """Return whether a channel passes already: a fleet has thousands with the same ending."""
        return not self._is_narrow or _ending(channel) in self._endings

    def let_pass(self, channels: Collection[str]) -> None:
        """Let only these channels and large messages pass; if they are many, also some others."""
        if not self._is_narrow:
            return
        (one,) = self._sockets
        self._endings, program = (), well_formed()
        endings = {_ending(channel) for channel in channels}
        if len(channels) <= _MOST:
            program = these_channels(channels)
        elif len(endings) <= _MOST and all(len(ending) == ENDING_BYTES for ending in endings):
            self._endings, program = endings, these_endings(endings)
        if not attach(one, program):
            self._is_narrow = False
            detach(one)
            attach(one, well_formed())
        mark(one, SUBSCRIBED)

    def close(self) -> None:
        """Close the sockets."""
        self._is_narrow = False
        while self._sockets:
            self._sockets.pop().close()


def _ending(channel: str) -> bytes:
    return channel.encode()[-ENDING_BYTES:]
