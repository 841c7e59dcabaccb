"""The bus of nodes on UDP multicast, on sockets of our own, in liblcm's wire format."""

import socket
import time
from collections import deque
from collections.abc import Collection, Sequence

from lcmtools.bus.base import Handler
from lcmtools.bus.channel_receiver import ChannelReceiver
from lcmtools.bus.group_receiver import MAX_DATAGRAM
from lcmtools.bus.kernel import ANCILLARY_BYTES, STAMP_KIND, bound_wait, received_at
from lcmtools.bus.multicast import check_multicast
from lcmtools.bus.receiving_bus import BATCH, ReceivingBus, encoded
from lcmtools.bus.udp_sender import UdpSender
from lcmtools.bus.url import BusUrl
from lcmtools.bus.wakeup import WakeupEvent
from lcmtools.wire.datagram import (
    CHANNEL_MAX,
    MAGIC_SHORT,
    MESSAGE_MAX,
    SHORT_HEADER_BYTES,
    Fragment,
    ShortMessage,
    parse,
)
from lcmtools.wire.packet import Datagram
from lcmtools.wire.reassembly import INCOMPLETE, Reassembler

_LATEST_END = SHORT_HEADER_BYTES + CHANNEL_MAX + 1  # latest end of a channel in a short message
_GAP = 0.005  # [s] at most between the messages of a stream
_GAP_NS = round(1e9 * _GAP)
_MOST_AT_ONCE = 2048
_LATE = 1_000_000  # [ns]: a message that has waited longer is one of many
_AT_FIRST = 1_000_000  # bytes of a large message that has room even before the first one comes
_MOST_UNCERTAIN = 16 << 20  # bytes of messages that are kept before their first fragments come


class UdpBus(ReceivingBus):
    """A multicast group, received with the filters of the channels that have handlers.

    Publishing is safe from any thread and from signal handlers. Handlers run on the receiving
    thread and must be quick.

    Attributes:
        ports: The UDP port that everything is sent from.
        overflows: As in ``Bus``.

    Raises:
        BusError: Multicast does not work here; the error says what to type.
    """

    def __init__(self, url: BusUrl) -> None:
        check_multicast(url)
        super().__init__(url)
        self._sockets = ChannelReceiver(url)
        self._only = self._sockets.all[0]  # the one socket while there are no others
        self._recvmsg = self._only.recvmsg
        self._can_await = bound_wait(self._only, _GAP)
        self._sender = UdpSender(url)
        self._send = self._sender.send
        self._sender.bind()
        self.ports = [self._sender.port]
        self._reassembler = Reassembler(max_bytes=2 * MESSAGE_MAX)
        self._read: deque[Datagram] = deque()  # in order of arrival; if there are several sockets
        self._is_streaming = False  # a message has come soon after the one before
        self._is_late = False
        self._latest = 0  # arrival of the latest message [ns]
        self.overflows = 0
        self._start()

    def publish_together(self, messages: Sequence[tuple[str, bytes]]) -> Collection[int]:
        """Send those of these messages that cost less if sent together (see ``Bus``)."""
        return self._sender.send_together(messages)

    def keep_order(self) -> None:
        """Let no message overtake a large one (see ``Bus``)."""
        self._sender.keeps_order = True

    def lost(self, channel: str) -> int:
        """Return the number of large messages on a channel that arrived incompletely."""
        return self._reassembler.lost.get(channel, 0)

    def _subscribe(self, channel: str, handler: Handler, *, is_large: bool = False) -> None:
        if is_large:
            self._sockets.make_room(_AT_FIRST)
        super()._subscribe(channel, handler)

    def _begin(self, channel: str) -> None:
        if not self._sockets.passes(channel):
            self._end(channel)

    def _end(self, channel: str) -> None:  # noqa: ARG002 - those that are left matter
        self._sockets.let_pass([*map(bytes.decode, self._handlers)])

    def _descriptors(self) -> Sequence[int]:
        return [one.fileno() for one in self._sockets.all]

    def _prepare(self) -> None:
        self._sockets.prepare(self._only)

    def _has_read(self) -> bool:
        return bool(self._read) or self._sockets.has_more

    def _leave(self) -> None:
        self._sender.close()
        self._sockets.close()

    def _wait_for_messages(self, event: WakeupEvent | None, timeout: float | None) -> bool:
        """Wait for messages, requests or an event; of a stream, for its next message only.

        The next message is awaited in its socket, where no event can wake this thread. This saves
        one system call before the callback, an eighth of the latency between processes. An event
        waits for that message, or for the gap that ends a stream.
        """
        if (
            self._is_streaming
            and not self._right.wakeup.is_set
            and not (event and event.is_set)
            and (timeout is None or timeout >= _GAP)
            and self._read_one(0)
        ):
            return True
        return super()._wait_for_messages(event, timeout)

    def _receive_on_own_thread(self) -> None:
        # at once if a callback keeps the other thread: each call may wait for the interpreter
        is_alone = len(self._sockets.all) == 1 and self._requests.empty()
        if is_alone and self._right.turns and self._drain():
            self.on_received()
        else:
            super()._receive_on_own_thread()

    def _receive(self, most: int) -> int:
        """Handle messages until one has just come, which need not wait for a look for more."""
        handled = 0
        if len(self._sockets.all) == 1:
            while handled < most and self._read_one(socket.MSG_DONTWAIT):
                handled += 1
                if not self._is_late:
                    break
                if self._right.thread == self._own_thread:  # a callback keeps the other busy
                    return handled + self._drain()
        else:
            if not self._read:
                self._read.extend(self._sockets.read(BATCH))
            handled = min(most, len(self._read))
            for _ in range(handled):
                data, sender, arrived, _ttl = self._read.popleft()
                self._take(data, sender[:2], arrived)
        if handled == most:
            self._count_overflows()
        return handled

    def _drain(self) -> int:
        """Handle all that waits with few calls, for each of which this thread may have to wait."""
        total, count = 0, BATCH
        while (
            count >= BATCH and total < _MOST_AT_ONCE and not self._closed and self._requests.empty()
        ):
            count = 0
            for data, sender, arrived, _ in self._sockets.datagrams(self._only, BATCH):
                self._take(data, sender[:2], arrived)
                count += 1
            total += count
            self._count_overflows()
        return total

    def _read_one(self, flags: int) -> bool:
        """Handle the next datagram at the only socket; return False if there is none."""
        try:
            data, ancillary, _, sender = self._recvmsg(MAX_DATAGRAM, ANCILLARY_BYTES, flags)
        except OSError:  # none, or a signal handler has closed the bus
            self._is_streaming = False
            return False
        now = arrived = time.time_ns()
        if ancillary and ancillary[0][1] == STAMP_KIND:  # as ``arrival``, in a third of the time
            arrived = received_at(ancillary[0][2])
        self._is_late = now - arrived > _LATE
        self._is_streaming = (
            self._can_await and arrived - self._latest < _GAP_NS and not self._is_late
        )
        self._latest = arrived
        self._take(data, sender, arrived)
        return True

    def _take(self, data: bytes, sender: tuple[object, ...], arrived: int) -> None:
        """Handle one datagram; a malformed one is ignored."""
        if data.startswith(MAGIC_SHORT):
            end = data.find(b"\0", SHORT_HEADER_BYTES, _LATEST_END)
            name = data[SHORT_HEADER_BYTES : max(0, end)]
            handlers = self._handlers.get(name)
            if handlers:
                self._handle(name, handlers, data[end + 1 :], arrived)
        elif isinstance(fragment := parse(data), Fragment):
            whole = self._join(fragment, sender, arrived)
            if whole is not None:
                self._dispatch(whole.channel, whole.payload, arrived)

    def _join(
        self, fragment: Fragment, sender: tuple[object, ...], arrived: int
    ) -> ShortMessage | None:
        """Add a fragment to its message; return the message if it is complete."""
        port, size, unwanted = sender[1], fragment.message_size, self._sockets.unwanted
        assert isinstance(port, int)
        if fragment.channel is not None:
            if encoded(fragment.channel) not in self._handlers:
                return None
            if unwanted.want(port):
                self._sockets.attach_filters()
            self._sockets.make_room(size)
        joined = self._reassembler
        joined.drop_before(arrived - INCOMPLETE)
        if fragment.channel is None and not joined.has_first(sender, fragment.seqno):
            if unwanted.note(port, size, arrived):
                self._sockets.attach_filters()
            if joined.kept_bytes > _MOST_UNCERTAIN:
                return None
        return joined.add(sender, fragment, arrived)

    def _count_overflows(self) -> None:
        """Count what the kernel dropped, if a socket's buffer is at least half full."""
        self._sockets.count_overflows()
        self.overflows = self._sockets.overflows
