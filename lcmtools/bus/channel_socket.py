"""A socket that receives one channel, whose messages wait in the kernel until they are read.

Waking up for each message costs far more than reading many at once. A filter in the kernel (Linux
only) accepts nothing but the channel. Meant for small messages that may be read a little later: if
the socket's buffer fills up between two reads, the newest are lost.
"""

import contextlib
import select

from lcmtools.bus.kernel import ANCILLARY_BYTES, SELECTIVE, arrival, attach, mark
from lcmtools.bus.multicast import receiving_socket
from lcmtools.bus.socket_filter import one_channel
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.wire import datagram

_NUMBER_OFFSET = 16  # offset of a fragment's number
_MAX_DATAGRAM = 65536
_MOST_AT_ONCE = 4096  # messages: a flood must not keep the reader busy


class ChannelSocket:
    """The messages of one channel of a multicast bus, from now on; for one thread at a time.

    Raises:
        BusError: The group cannot be joined, or this system has no such filters.
    """

    def __init__(self, url: BusUrl, channel: str) -> None:
        self._name = channel.encode() + b"\0"
        self.has_large = False
        """True once a message came in several fragments, which are not received here."""
        self._buffer = memoryview(bytearray(_MAX_DATAGRAM))
        self._receiver = receiving_socket(url)
        self._receiver.setblocking(False)  # noqa: FBT003 - socket's signature
        if not attach(self._receiver, one_channel(channel)):
            self._receiver.close()
            raise BusError("this system cannot filter datagrams")
        self._poll = select.poll()
        self._poll.register(self._receiver, select.POLLIN)
        mark(self._receiver, SELECTIVE)

    def receive(self) -> list[tuple[bytes, int]]:
        """Return waiting payloads with their receive times [ns since 1970]; never blocks."""
        received: list[tuple[bytes, int]] = []
        head = datagram.SHORT_HEADER_BYTES
        start = head + len(self._name)
        with contextlib.suppress(OSError):  # BlockingIOError: no more are waiting
            for _ in range(_MOST_AT_ONCE):
                size, ancillary, *_ = self._receiver.recvmsg_into([self._buffer], ANCILLARY_BYTES)
                data = bytes(self._buffer[:size])
                # compared again: datagrams from before the filter was attached may be any
                if data.startswith(datagram.MAGIC_SHORT) and data[head:start] == self._name:
                    received.append((data[start:], arrival(ancillary)[0]))
                elif data.startswith(datagram.MAGIC_FRAGMENT) and self._begins_large(data):
                    self.has_large = True
        return received

    def wait(self, seconds: float) -> bool:
        """Wait for a message, ``seconds`` at most; return False if none came."""
        return bool(self._poll.poll(1000 * seconds))

    def close(self) -> None:
        """Leave the group."""
        self._receiver.close()

    def _begins_large(self, fragment: bytes) -> bool:
        is_first = fragment[_NUMBER_OFFSET : _NUMBER_OFFSET + 2] == b"\0\0"
        return is_first and fragment.startswith(self._name, datagram.FRAGMENT_HEADER_BYTES)
