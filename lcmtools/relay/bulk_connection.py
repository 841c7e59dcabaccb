"""A second connection to a tcpq server, on which large messages delay no small ones.

On one connection a command would wait until all of an image has passed. ``relay --serve`` sends
large messages for a client to its second connection; other servers send them to the first.
"""

import contextlib
import errno
import select
import socket
import threading
import time
from collections.abc import Callable

from lcmtools.bus.kernel import drop_what_is_late
from lcmtools.bus.line_buffer import LineBuffer
from lcmtools.bus.url import BusUrl
from lcmtools.relay.fair_queue import LATE, LineMessage, LineQueue
from lcmtools.wire import tcpq
from lcmtools.wire.packet import Packet

BULK_BYTES = 4000  # a channel with larger messages uses the second connection
_TIMEOUT = 0.5  # [s]
_RETRY = 2.0  # [s]
_STUCK = 5.0  # [s]
_WAIT = 0.1  # [s]
_READ_BYTES = 1 << 18


class BulkConnection:
    """The connection, with the messages that wait for it and the thread that sends them.

    ``note`` is called before a message is sent.
    """

    def __init__(self, url: BusUrl, note: Callable[[LineMessage], None]) -> None:
        self._address = (url.host, url.port)
        self._note = note
        self.queue = LineQueue()
        self.failed = 0  # messages that could not be sent
        self._partner = ""
        self._connection: socket.socket | None = None
        self._buffer: LineBuffer | None = None
        self._next = 0.0
        self._reader = tcpq.FrameReader(tcpq.SERVER_GREETING)
        self._closed = False
        self._thread = threading.Thread(target=self._send_all, name="bulk sender", daemon=True)
        self._thread.start()

    @property
    def sockets(self) -> list[socket.socket]:
        """The socket to wait for, if there is a connection."""
        return [self._connection] if self._connection else []

    def attend(self, partner: str) -> None:
        """Connect, if necessary; ``partner`` is the address of the first connection."""
        if partner != self._partner:
            self._partner = partner
            self._disconnect()
            self._next = 0.0
        now = time.monotonic()
        if self._connection or not partner or now < self._next:
            return
        self._next = now + _RETRY
        with contextlib.suppress(OSError):
            connection = socket.create_connection(self._address, timeout=_TIMEOUT)
            connection.sendall(tcpq.CLIENT_GREETING + tcpq.subscribe_frame(tcpq.LARGE + partner))
            connection.setblocking(False)  # noqa: FBT003 - the socket module's own
            drop_what_is_late(connection, LATE)
            self._reader = tcpq.FrameReader(tcpq.SERVER_GREETING)
            self._connection, self._buffer = connection, LineBuffer(connection)

    def receive(self) -> list[Packet]:
        """Return the messages that have arrived, without waiting."""
        connection, now = self._connection, time.time_ns()
        if connection is None:
            return []
        try:
            data = connection.recv(_READ_BYTES)
            frames = list(self._reader.read(data))
        except BlockingIOError:
            return []
        except (OSError, tcpq.StreamError):
            data = b""
        if not data:
            self._disconnect()
            return []
        return [Packet(one.name, tcpq.payload_of(one), now) for one in frames]

    def close(self) -> None:
        """End the thread and the connection."""
        self._closed = True
        self.queue.close()
        self._thread.join(LATE)
        self._disconnect()

    def _disconnect(self) -> None:
        connection, self._connection = self._connection, None
        if connection:
            connection.close()

    def _send_all(self) -> None:
        while not self._closed:
            for message in self.queue.pop(_WAIT):
                if self.queue.is_late(message):
                    continue
                try:
                    self._send(message)
                except (OSError, ValueError):  # closed meanwhile
                    self.failed += 1
                    self._disconnect()

    def _send(self, message: LineMessage) -> None:
        connection, buffer = self._connection, self._buffer
        if connection is None or buffer is None:
            raise ConnectionError(errno.ENOTCONN, "there is no connection")
        self._note(message)
        left = memoryview(tcpq.publish_frame(message.channel, message.payload))
        poll = select.poll()
        poll.register(connection, select.POLLOUT)
        while left:
            if not poll.poll(_STUCK * 1000):
                raise TimeoutError(errno.ETIMEDOUT, "the server reads nothing")
            buffer.adjust(connection, time.monotonic())
            with contextlib.suppress(BlockingIOError):
                left = left[connection.send(left[: buffer.piece_bytes]) :]
