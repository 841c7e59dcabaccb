"""The kernel's filter before the sockets of an LCM instance.

liblcm's thread would wake for each datagram of the bus, its own process's included, to find that
nobody has subscribed to its channel: for a node that sends fast, that is a third of what sending
costs. On other systems than Linux it does.
"""

import socket
from collections.abc import Collection, Iterable

from lcmtools.bus.kernel import ANNOUNCED, SUBSCRIBED, attach, detach, mark
from lcmtools.bus.socket_filter import ENDING_BYTES, these_channels, these_endings, well_formed

_MOST = 50  # channels, or endings, that a datagram is compared with


class ChannelFilter:
    """Malformed datagrams are dropped, and from the first ``let_pass`` on channels, too.

    It is before sockets on which the instance receives, or duplicates; ``close`` closes them.
    """

    def __init__(self, sockets: Iterable[socket.socket]) -> None:
        self._sockets = list(sockets)
        for one in self._sockets:
            attach(one, well_formed())
            mark(one, ANNOUNCED)
        # of several, others may belong to an instance that another thread has just made
        self._is_narrow = len(self._sockets) == 1
        self._endings: Collection[bytes] = ()
        """Of channels that pass, if they are told apart by these alone."""

    def passes(self, channel: str) -> bool:
        """Return whether a channel passes already: a fleet has thousands of one ending."""
        return not self._is_narrow or _ending(channel) in self._endings

    def let_pass(self, channels: Collection[str]) -> None:
        """Let only these channels pass, and large messages; others, too, where these are many."""
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
        """Let go of the sockets."""
        self._is_narrow = False
        while self._sockets:
            self._sockets.pop().close()


def _ending(channel: str) -> bytes:
    return channel.encode()[-ENDING_BYTES:]
