"""The bus of nodes on UDP multicast, on sockets of our own, in liblcm's wire format."""

import contextlib
import socket
import time
from collections import deque
from collections.abc import Collection, Sequence
from threading import get_ident

from lcmtools.bus.base import Handler, Shortcut
from lcmtools.bus.group_receiver import MAX_DATAGRAM, GroupReceiver
from lcmtools.bus.kernel import STAMP_KIND, STAMP_ROOM, bound_wait, received_at
from lcmtools.bus.multicast import check_multicast
from lcmtools.bus.network_watch import network_watch
from lcmtools.bus.receiving_bus import BATCH, ReceivingBus, encoded
from lcmtools.bus.udp_sender import UdpSender
from lcmtools.bus.url import BusUrl
from lcmtools.bus.wakeup import WakeupEvent, wait_readable
from lcmtools.wire.datagram import MESSAGE_MAX, Fragment, parse, split_short
from lcmtools.wire.packet import Datagram
from lcmtools.wire.reassembly import Reassembler

_GAP = 0.005  # [s] at most between the messages of a stream
_GAP_NS = round(1e9 * _GAP)
_MOST_AT_ONCE = 2048
_TURNS = 256  # messages of a stream, after which there is a look at everything else
_OWN = 3  # descriptors that are awaited beside those of the network
_LATE = 1_000_000  # [ns]: a message that has waited longer is one of many
_AT_FIRST = 1_000_000  # bytes of a large message that has room even before the first one comes
_MOST_EARLY = 16 << 20  # bytes of messages that are kept before their first fragments come


class UdpBus(ReceivingBus):
    """A multicast group, received with the filters of the channels that have handlers.

    Publishing is safe from any thread and from signal handlers. Handlers run on the receiving
    thread; on one that waits, they may take their time.

    Attributes:
        ports: The UDP port that everything is sent from.
        overflows: As in ``Bus``.

    Raises:
        BusError: Multicast does not work here; the error says what to type.
    """

    runs_callbacks = True

    def __init__(self, url: BusUrl) -> None:
        check_multicast(url)
        super().__init__(url)
        with contextlib.ExitStack() as opened:
            self._sockets = GroupReceiver(url, channels=())
            opened.callback(self._sockets.close)
            self._sender = UdpSender(url)
            opened.callback(self._sender.close)
            self._sender.bind()
            opened.pop_all()
        self._only = self._sockets.all[0]  # the one socket while there are no others
        self._recvmsg = self._only.recvmsg
        self._can_await = bound_wait(self._only, _GAP)
        self._send = self._sender.send
        self.ports = [self._sender.port]
        self._reassembler = Reassembler(
            self._wants, max_bytes=2 * MESSAGE_MAX, max_early_bytes=_MOST_EARLY
        )
        self._read: deque[Datagram] = deque()  # in order of arrival; if there are several sockets
        self._is_streaming = False  # a message has come soon after the one before
        self._is_late = False
        self._latest = 0  # arrival of the latest message [ns]
        self._watched: tuple[WakeupEvent | None, tuple[int, ...]] = None, ()
        self._start()
        self._right.is_pressing = False  # until large messages come

    def publish_together(self, messages: Sequence[tuple[str, bytes]]) -> Collection[int]:
        """Send those of these messages that cost less if sent together (see ``Bus``)."""
        return self._sender.send_together(messages)

    def shortcut(self, channel: str) -> Shortcut:
        """Return the shortest way to publish short payloads on a channel (see ``Bus``)."""
        return self._sender.shortcut(channel)

    def keep_order(self) -> None:
        """Let no message overtake a large one (see ``Bus``)."""
        self._sender.keeps_order = True

    def leave_to_parent(self) -> None:
        """Refuse all use in a forked process; see ``Bus``."""
        super().leave_to_parent()
        self._sender.is_open = False

    def lost(self, channel: str) -> int:
        """Return the number of large messages on a channel that arrived incompletely."""
        return self._reassembler.lost.get(channel, 0)

    def wait(self, wakeup: WakeupEvent, timeout: float | None) -> None:
        """Receive on this thread until handlers were called or time is up (see ``Bus``).

        Messages that come one by one take the short way, where ``come`` and ``leave`` are written
        out: a thread that has slept pays for each call.
        """
        right, is_over = self._right, False
        sockets = self._sockets
        has_others = self._read or sockets.held or len(sockets.all) > 1
        is_short = not (has_others or self._is_late or self._closed)
        if is_short and right.is_lendable and right.lead.acquire(False):  # noqa: FBT003
            try:
                right.leader = right.latest = get_ident()
                right.is_away = False
                is_over = not (
                    right.is_taken
                    or right.wakeup.is_set
                    or wakeup.is_set
                    or not right.turns % _TURNS  # the network may have changed
                ) and self._await_one(wakeup, timeout)
            finally:
                right.is_away = True
                right.turns += 1
                right.leader = 0
                right.lead.release()
                if right.is_own_asleep:
                    right.wake_own()
        if not is_over:
            super().wait(wakeup, timeout)

    def _await_one(self, wakeup: WakeupEvent, timeout: float | None) -> bool:
        """Handle one message; return False if there is something else to do than that.

        The next message of a stream is awaited in its socket, where no event can wake this thread.
        This saves one system call before the callback, an eighth of the latency between processes.
        An event waits for that message, or for the gap that ends a stream.
        """
        if self._is_streaming and (timeout is None or timeout >= _GAP):
            return self._read_one(0)
        if self._watched[0] is not wakeup:
            own, network = self._right.wakeup.fileno(), network_watch.descriptors
            self._watched = wakeup, (self._only.fileno(), own, wakeup.fileno(), *network)
        watched = self._watched[1]
        if len(watched) == _OWN:  # the system reports no changes of the network
            return False
        try:
            readable = wait_readable(watched, timeout)
        except (OSError, ValueError):  # a signal handler has closed the bus
            return False
        return not readable or (readable == [watched[0]] and self._read_one(socket.MSG_DONTWAIT))

    def _wants(self, channel: str) -> bool:
        return encoded(channel) in self._handlers

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
        return bool(self._read or self._sockets.held)

    def _leave(self) -> None:
        self._sender.close()
        self._sockets.close()

    def _receive_on_own_thread(self) -> None:
        # at once if a callback keeps the leader: each call may wait for the interpreter
        is_alone = len(self._sockets.all) == 1 and self._requests.empty()
        if is_alone and self._right.turns and self._drain():
            self.on_received()
        else:
            super()._receive_on_own_thread()

    def _receive(self, most: int) -> int:
        """Handle messages until one has just come, which need not wait for a look for more."""
        handled = 0
        if len(self._sockets.all) == 1 and not self._has_read():
            while handled < most and not self._closed and self._read_one(socket.MSG_DONTWAIT):
                handled += 1
                if not self._is_late:
                    break
                if get_ident() == self._right.own:  # a callback keeps the leader busy
                    return handled + self._drain()
        else:
            if not self._read:
                self._read.extend(self._sockets.read(BATCH))
            while handled < most and self._read and not self._closed:
                data, sender, arrived, _ttl = self._read.popleft()
                self._take(data, (sender.address, sender.port), arrived)
                handled += 1
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
                self._take(data, (sender.address, sender.port), arrived)
                count += 1
            total += count
            self._count_overflows()
        return total

    def _read_one(self, flags: int) -> bool:
        """Handle the next datagram at the only socket; return False if there is none."""
        try:
            data, ancillary, _, sender = self._recvmsg(MAX_DATAGRAM, STAMP_ROOM, flags)
        except OSError:  # none, or a signal handler has closed the bus
            self._is_streaming = False
            return False
        now = arrived = time.time_ns()
        if ancillary and ancillary[0][1] == STAMP_KIND:
            arrived = received_at(ancillary[0][2])
        self._is_late = now - arrived > _LATE
        self._is_streaming = (
            self._can_await and not self._is_late and arrived - self._latest < _GAP_NS
        )
        self._latest = arrived
        self._take(data, sender, arrived)
        return True

    def _take(  # noqa: C901 - without calls: it is the path of each message
        self, data: bytes, sender: tuple[str, int], arrived: int
    ) -> None:
        """Call the handlers of the message that a datagram completes; a malformed one is ignored.

        A leader is away meanwhile, as they may run callbacks.
        """
        name, payload = split_short(data)
        if payload is None:
            name, payload = self._join(data, sender, arrived)
        handlers = self._handlers.get(name)
        if not handlers or payload is None:
            return
        right = self._right
        if is_leader := right.leader == get_ident():
            right.is_away = True
            right.turns += 1
            if right.is_own_asleep:
                right.wake_own()
        for handler in handlers:
            try:
                handler(payload, arrived)
            except Exception as error:  # noqa: BLE001, PERF203 - others receive it all the same
                self._note_fault(name, error)
        if is_leader and not self._closed:
            right.is_away = False
            if right.is_taken:
                right.come()

    def _join(
        self, data: bytes, sender: tuple[str, int], arrived: int
    ) -> tuple[bytes, bytes | None]:
        """Add a fragment; return the message that it completes as ``split_short`` does."""
        fragment = parse(data)
        if not isinstance(fragment, Fragment):
            return b"", None
        self._right.is_pressing = True
        if fragment.channel is None:
            if not self._reassembler.has_first(sender, fragment.seqno):
                self._sockets.note_unwanted(sender[1], fragment.message_size, arrived)
        elif self._wants(fragment.channel):
            self._sockets.want(sender[1], fragment.message_size)
        whole = self._reassembler.add(sender, fragment, arrived)
        return (encoded(whole.channel), whole.payload) if whole else (b"", None)

    def _count_overflows(self) -> None:
        """Count what the kernel dropped, if a socket's buffer is at least half full."""
        self._sockets.count_overflows()
        self.overflows = self._sockets.overflows
