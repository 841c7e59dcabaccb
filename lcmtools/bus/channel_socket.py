"""A socket that receives one channel, whose messages wait in the kernel until they are read.

Waking up for each message costs far more than reading many at once. A filter in the kernel (Linux
only) accepts nothing but the channel. Meant for small messages that may be read a little later: if
the socket's buffer fills up between two reads, the newest are lost.
"""

import contextlib
import select

from lcmtools.bus.group_receiver import one_by_one
from lcmtools.bus.kernel import SELECTIVE, attach, mark
from lcmtools.bus.multicast import receiving_socket
from lcmtools.bus.socket_filter import one_channel
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.wire.datagram import MalformedDatagram, ShortMessage, parse

_MOST_AT_ONCE = 4096  # messages: a flood must not keep the reader busy


class ChannelSocket:
    """The messages of one channel of a multicast bus, from now on; for one thread at a time.

    Raises:
        BusError: The group cannot be joined, or this system has no such filters.
    """

    def __init__(self, url: BusUrl, channel: str) -> None:
        self._channel = channel
        self.has_large = False
        """True once a message came in several fragments, which are not received here."""
        self._receiver = receiving_socket(url)
        if not attach(self._receiver, one_channel(channel)):
            self._receiver.close()
            raise BusError("this system cannot filter datagrams")
        self._poll = select.poll()
        self._poll.register(self._receiver, select.POLLIN)
        mark(self._receiver, SELECTIVE)

    def receive(self) -> list[tuple[bytes, int]]:
        """Return waiting payloads with their receive times [ns since 1970]; never blocks."""
        received: list[tuple[bytes, int]] = []
        with contextlib.suppress(OSError):
            for data, _, arrived, _ in one_by_one(self._receiver, _MOST_AT_ONCE):
                found = parse(data)
                # compared again: datagrams from before the filter was attached may be any
                if isinstance(found, MalformedDatagram) or found.channel != self._channel:
                    continue
                if isinstance(found, ShortMessage):
                    received.append((found.payload, arrived))
                else:
                    self.has_large = True
        return received

    def wait(self, seconds: float) -> bool:
        """Wait for a message, ``seconds`` at most; return False if none came."""
        return bool(self._poll.poll(1000 * seconds))

    def close(self) -> None:
        """Leave the group."""
        self._receiver.close()
