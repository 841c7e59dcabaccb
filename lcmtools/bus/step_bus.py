"""The bus of a node that plays a recording in lock-step (``bag rerun``): tcpq without liblcm.

A step takes one system call to wait, one to read and one to write; with liblcm, which sends each
frame in five pieces, it takes 25 and two or three times as long. The connection lasts as long as
the program, so nothing is reconnected.
"""

import re
import socket
import threading
from collections.abc import Sequence

from lcmtools.bus.receiving_bus import ReceivingBus
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError, os_errors_as
from lcmtools.wire import tcpq

STEP_CHANNEL, DONE_CHANNEL = "/_lcmtools/step", "/_lcmtools/done"
_READ_BYTES = 1 << 18


class StepBus(ReceivingBus):
    """A connection to the program that plays the recording.

    What is published goes out with the next answer to a step, or after ``BURST`` bytes, or at once
    if no step is being done.

    Raises:
        BusError: There is no such server.
    """

    def __init__(self, url: BusUrl) -> None:
        super().__init__(url)
        with os_errors_as(f"cannot connect to {url}", kind=BusError):
            self._connection = socket.create_connection((url.host, url.port))
        self._connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._reader = tcpq.FrameReader(tcpq.SERVER_GREETING)
        self._has_ended = False
        self._sending = threading.RLock()  # not Lock: a signal handler may publish too
        self._waiting: list[bytes] = []  # frames to be sent with the answer
        self._is_in_step = self._has_answered = False
        self._send = self._send_message
        self._write(tcpq.CLIENT_GREETING)
        self._start()

    def _send_message(self, channel: str, payload: bytes) -> None:
        frame = tcpq.publish_frame(channel, payload)
        with self._sending:
            if channel == DONE_CHANNEL:
                self._is_in_step, self._has_answered = False, True
            self._waiting.append(frame)
            if not self._is_in_step:
                self._write(b"".join(self._waiting))
                self._waiting.clear()

    def _write(self, data: bytes) -> None:
        with self._sending:
            self._connection.sendall(data)

    def _begin(self, channel: str) -> None:
        self._write(tcpq.subscribe_frame(re.escape(channel)))

    def _end(self, channel: str) -> None:
        """Do nothing: what comes nevertheless has no handler."""

    def _descriptors(self) -> Sequence[int]:
        return () if self._has_ended else (self._connection.fileno(),)

    def _receive(self, most: int) -> int:  # noqa: ARG002 - one step is all that comes
        try:
            data = self._connection.recv(_READ_BYTES, socket.MSG_DONTWAIT)
        except BlockingIOError:
            return 0
        except OSError:
            data = b""
        self._has_ended = not data
        frames = list(self._reader.read(data))
        has_step = any(one.name == STEP_CHANNEL for one in frames)
        self._is_in_step |= self._has_answered and has_step  # else it may never answer one
        for frame in frames:
            self._dispatch(frame.name, tcpq.payload_of(frame))
        return 1

    def _leave(self) -> None:
        self._connection.close()
