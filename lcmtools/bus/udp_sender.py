"""Sending a bus's messages from one port: small ones at once, large ones such that they arrive.

liblcm sends all fragments of a message in one burst, and with a system's stock receive buffers
nothing above 190 kB gets through. Here the fragments have the same wire format, but each is
followed by a pause in which receivers can empty their buffers. A plain LCM program needs no
changes.

Small messages of one size, as a fleet sends them, pass through the system together: one by one,
this takes longer than computing them.
"""

import contextlib
import itertools
import time
from collections import Counter, deque
from collections.abc import Sequence

from lcmtools.bus.base import SendingThread, Shortcut
from lcmtools.bus.kernel import cuts_datagrams, send_cut
from lcmtools.bus.multicast import send_to_group, sending_socket
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.wire.datagram import (
    CHANNEL_MAX,
    MAGIC_FRAGMENT,
    MAGIC_SHORT,
    MESSAGE_MAX,
    SHORT_HEADER_BYTES,
    SHORT_MESSAGE_MAX,
    datagrams,
    short_head,
    short_message,
)

PACED_ABOVE_BYTES = 120_000  # payloads up to this size fit stock receive buffers in one burst

MAX_WAITING_BYTES = 64 << 20
"""Once this much is queued, a publisher that is faster than the pace has to wait."""

_SURELY_SHORT = SHORT_MESSAGE_MAX - CHANNEL_MAX - 1  # payload that fits into a datagram [byte]
_PAUSE = 0.0002  # [s] after each fragment; three fragments fit stock buffers (212 992 bytes)
_MOST_TOGETHER = 32  # messages; a stock receive buffer holds three times as many
_MOST_BYTES_TOGETHER = 65_000  # on their way they form one datagram


class UdpSender(SendingThread[tuple[str, bytes]]):
    """Sends messages, those of each channel in the given order; all, if it ``keeps_order``.

    Large messages, and any that would overtake one, are sent by its own thread.
    """

    keeps_order = False
    is_open = True

    def __init__(self, url: BusUrl) -> None:
        super().__init__("paced sender")
        self._address = (url.host, url.port)
        self._socket = sending_socket(url)
        self._sendto = self._socket.sendto
        self._cuts = cuts_datagrams(self._socket)
        self._numbers = itertools.count()  # each thread that sends takes the next, without a lock
        self._waiting: deque[tuple[str, bytes]] = deque()
        # of messages that wait or are being sent, which others must not overtake
        self._channels: Counter[str] = Counter()
        self._waiting_bytes = 0

    @property
    def port(self) -> int:
        """The UDP port that messages come from; 0 before the first one and ``bind``."""
        return int(self._socket.getsockname()[1])

    def bind(self) -> None:
        """Bind the port before the first message."""
        self._socket.bind(("", 0))

    def send(self, channel: str, payload: bytes) -> None:
        """Send one message, or queue it. Waits only while MAX_WAITING_BYTES are queued.

        Raises:
            BusError: The message is larger than LCM's receivers accept, or the sender is closed.
            OSError: The system does not send it.
        """
        size = len(payload)
        waiting = self._channels
        if size > PACED_ABOVE_BYTES or channel in waiting or (self.keeps_order and waiting):
            self._queue(channel, payload)
        elif size > _SURELY_SHORT:
            self.send_at_once(channel, payload)
        else:
            datagram = short_message(next(self._numbers), channel, payload)
            try:
                self._sendto(datagram, self._address)
            except OSError:
                send_to_group(self._socket, datagram, self._address)

    def shortcut(self, channel: str) -> Shortcut:
        """Return a function that does for a channel's short payloads what ``send`` does."""
        head, name = short_head, short_message(0, channel, b"")[SHORT_HEADER_BYTES:]
        numbers, sendto, address = self._numbers, self._sendto, self._address

        def send_short(payload: bytes) -> bool:
            if self._channels or not self.is_open or len(payload) > _SURELY_SHORT:
                return False
            datagram = head(MAGIC_SHORT, next(numbers) & 0xFFFFFFFF) + name + payload
            try:
                sendto(datagram, address)
            except OSError:
                send_to_group(self._socket, datagram, address)
            return True

        return send_short

    def send_at_once(self, channel: str, payload: bytes) -> None:
        """Send one message before this returns, as liblcm does.

        Raises:
            OSError: The system does not send it.
        """
        for datagram in datagrams(next(self._numbers), channel, payload):
            send_to_group(self._socket, datagram, self._address)

    def send_together(self, messages: Sequence[tuple[str, bytes]]) -> list[int]:
        """Send short messages with one call for each group of the same size, in their order.

        Returns the indices of the messages that must be sent in another way.
        """
        sizes: dict[int, list[int]] = {}
        for place, (channel, payload) in enumerate(messages):
            sizes.setdefault(
                len(channel.encode("utf-8", "surrogateescape")) + len(payload), []
            ).append(place)
        left: list[int] = []
        for size, places in sizes.items():
            most = max(1, min(_MOST_TOGETHER, _MOST_BYTES_TOGETHER // size))
            for start in range(0, len(places), most):
                part = places[start : start + most]
                if len(part) == 1 or not self._send_alike([messages[place] for place in part]):
                    left += part
        return left

    def close(self) -> None:
        """Send queued messages, for half a second at most, and close the socket."""
        self.is_open = False
        super().close()
        self._socket.close()

    def _send_alike(self, messages: Sequence[tuple[str, bytes]]) -> bool:
        """Send short messages of one size with one call; return False if none could be sent."""
        # those of a channel on which a large one waits must not overtake it
        if not self._cuts or self._channels:
            return False
        cut = [short_message(next(self._numbers), *message) for message in messages]
        try:
            send_cut(self._socket, cut, self._address)
        except OSError:
            return False
        return True

    def _queue(self, channel: str, payload: bytes) -> None:
        if len(payload) > MESSAGE_MAX:
            size = f"{len(payload)} bytes are more than LCM carries ({MESSAGE_MAX})"
            raise BusError(f"{channel}: {size}")
        with self._changed:
            try:
                self._start()
            except BusError:  # then without pauses
                self.send_at_once(channel, payload)
                return
            self._changed.wait_for(lambda: self._closed or self._waiting_bytes < MAX_WAITING_BYTES)
            if self._closed:
                raise BusError("the bus is closed")
            self._waiting.append((channel, payload))
            self._channels[channel] += 1
            self._waiting_bytes += len(payload)
            self._changed.notify_all()

    def _next(self) -> tuple[str, bytes] | None:
        return self._waiting[0] if self._waiting else None

    def _note_sent(self, message: tuple[str, bytes]) -> None:
        channel, payload = message
        self._waiting.popleft()
        self._channels -= Counter([channel])  # only now; removes a channel without messages
        self._waiting_bytes -= len(payload)

    def _send_now(self, message: tuple[str, bytes]) -> None:
        # a message that cannot be sent is lost, as any datagram may be; the next one is tried
        with contextlib.suppress(OSError):
            for datagram in datagrams(next(self._numbers), *message):
                send_to_group(self._socket, datagram, self._address)
                if datagram.startswith(MAGIC_FRAGMENT):
                    time.sleep(_PAUSE)
