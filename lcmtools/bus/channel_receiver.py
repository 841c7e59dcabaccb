"""The sockets of a bus for nodes, whose filters drop in the kernel what nobody subscribes to.

Without the filters, the receiving thread would wake for each datagram of the bus, even for its own
process's, only to find that nobody subscribes to its channel: for a node that sends at a high rate,
this is a third of the cost of sending. On systems other than Linux everything passes.
"""

from collections.abc import Collection

from lcmtools.bus.group_receiver import GroupReceiver
from lcmtools.bus.kernel import ANNOUNCED, SUBSCRIBED, mark
from lcmtools.bus.socket_filter import (
    ENDING_BYTES,
    ChannelTest,
    FilterProgram,
    everything,
    nothing,
    these_channels,
    these_endings,
    wanted,
)
from lcmtools.bus.unwanted import UnwantedMessages
from lcmtools.bus.url import BusUrl

_MOST = 50  # at most that a datagram is compared with: channels, or endings of their names


class ChannelReceiver(GroupReceiver):
    """The sockets that receive some channels, initially none.

    Attributes:
        unwanted: The large messages to be dropped; call ``attach_filters`` after changes.
    """

    largest_together, mark, is_observer = 3, SUBSCRIBED, False

    def __init__(self, url: BusUrl) -> None:
        super().__init__(url, nothing())
        mark(self.all[0], ANNOUNCED)
        self.unwanted = UnwantedMessages()
        self._tests: dict[ChannelTest, Collection[bytes]] = {everything: ()}
        """The tests of channels, the strictest first, and the endings that each compares."""
        self._test: ChannelTest = everything
        self._endings: Collection[bytes] = ()
        """The endings of channels that pass, if only the endings are compared."""

    def passes(self, channel: str) -> bool:
        """Return whether a channel passes already: a fleet has thousands with the same ending."""
        return _ending(channel) in self._endings

    def let_pass(self, channels: Collection[str]) -> None:
        """Let only these channels pass; if they are many, also some others."""
        self._tests = {}
        endings = {_ending(channel) for channel in channels}
        if len(channels) <= _MOST:
            self._tests[these_channels(channels)] = ()
        if len(endings) <= _MOST and all(len(ending) == ENDING_BYTES for ending in endings):
            self._tests[these_endings(endings)] = endings
        self._tests[everything] = ()
        self.unwanted.clear()
        self.attach_filters()

    def attach_filters(self) -> None:
        """Drop what is unwanted now, with the strictest filter for which the system has memory."""
        for self._test, self._endings in self._tests.items():  # noqa: B020
            if (not self.shares or self._attach_to_fragments()) and self._attach_to_shorts():
                return
        if self.shares:
            self._unite()

    def short_program(self, share: int, shares: int) -> FilterProgram:  # noqa: ARG002 - one socket
        """Return the filter of the socket for short messages; at first also for fragments."""
        return wanted(self._test, self.unwanted.denied, share=None if self.shares else (0, 1))

    def fragment_program(self, share: int, shares: int) -> FilterProgram:
        """Return the filter of a socket for fragments."""
        return wanted(self._test, self.unwanted.denied, shorts=False, share=(share, shares))


def _ending(channel: str) -> bytes:
    return channel.encode()[-ENDING_BYTES:]
