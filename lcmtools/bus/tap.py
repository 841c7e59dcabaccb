"""The tap: a passive observer of a multicast group's datagrams.

It joins the group like its members and sees every sender, including programs without lcmtools. It
decodes nothing, and no datagram makes it fail.

By default it reads only the heads of large messages: the first datagram has channel, type, size and
number, and on Linux a filter in the kernel drops the others, so that watching a bus full of images
costs almost nothing.
"""

import contextlib
import time
from collections.abc import Callable, Mapping, Sequence
from operator import itemgetter

from lcmtools.bus.group_receiver import ChannelSocket, GroupReceiver
from lcmtools.bus.kernel import buffer
from lcmtools.bus.multicast import check_multicast
from lcmtools.bus.network_watch import network_watch
from lcmtools.bus.udp_sender import UdpSender
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError, os_errors_as
from lcmtools.names import check_length
from lcmtools.wire.datagram import MAGIC_FRAGMENT, SHORT_MESSAGE_MAX
from lcmtools.wire.packet import Packet, Sender
from lcmtools.wire.reader import Reader
from lcmtools.wire.sequence import Sequence as Numbers

_NO_LIMIT = 0xFFFFFFFF  # bytes
_BATCH = 2048  # datagrams read in one turn
_STREAM, _STREAM_GAP, _NAP = 8, 0.005, 0.01
"""After this many turns that waited less than this time [s], turns begin with a nap [s]."""
_OF_A_NAP = _BATCH // 2  # messages that may come during a nap
_FILLED, _LITTLE = 0.5, 0.01  # part of the kernel's buffer that they may fill; the least counted
LONG_NAP = 0.1  # a nap for counting messages [s]: the kernel notes their times
_DEAF_NAP = 0.04  # [s]: a longer nap ends with a probe, whose sender waits 0.05 s for nodes

_AT_FIRST = 1_000_000  # bytes of a large message that has room even before the first one comes
_SHORT_ROOM, _MOST_GROWTH = 900, 1.5
"""A short message's overhead, and the factor of its size, which is rounded to powers of two."""
_PAYLOAD: Callable[[Packet], bytes] = itemgetter(1)


class Tap(contextlib.AbstractContextManager["Tap"]):
    """An observer of one multicast group.

    Args:
        url: The bus.
        whole: Assemble large messages; else only their heads are read (``Packet.whole_bytes``).
        spread: Receive with several sockets if large messages would not fit into the buffer of one
            (see ``GroupReceiver``); for observers that need all of them.
        large_only: Read only messages that are fragmented (see ``pass_large``).
        hears_itself: False if what it sends need not be received, with ``spread``; some may be.

    Attributes:
        longest_nap: The time [s] that messages of a stream may wait, to be read together.
        sender: Sends what the tap sends.
        malformed, sequences, ttls: As in ``Reader``.

    Raises:
        BusError: Multicast does not work here; the error says what to type.
    """

    is_live, is_log, is_awaiting, has_strangers = True, False, False, False

    def __init__(
        self,
        url: BusUrl,
        *,
        whole: bool = False,
        spread: bool = False,
        large_only: bool = False,
        hears_itself: bool = True,
    ) -> None:
        check_multicast(url)
        with contextlib.ExitStack() as opened:
            self.sender = UdpSender(url)
            opened.callback(self.sender.close)
            if not hears_itself:
                self.sender.bind()
            own_port = 0 if hears_itself else self.sender.port
            self._sockets = GroupReceiver(url, heads=not whole, own_port=own_port)
            opened.pop_all()
        self._is_spread = spread
        if spread:
            self._sockets.make_room(_AT_FIRST)
        self.longest_nap = 0.0 if whole else _NAP
        self._nap = _NAP
        self._is_whole = whole
        self._large_only = large_only
        if large_only:
            self.pass_large(_NO_LIMIT)
        self._reader = Reader(whole=whole)
        self.malformed: Mapping[Sender, str] = self._reader.malformed
        self.sequences: Mapping[Sender, Numbers] = self._reader.sequences
        self.ttls: Mapping[Sender, int] = self._reader.ttls
        self._turns = 0
        self._url = url
        self._requests: ChannelSocket | None = None

    def __exit__(self, *_: object) -> None:
        """Leave the group."""
        self.close()

    def close(self) -> None:
        """Leave the group."""
        self._sockets.close()
        self.sender.close()
        if self._requests:
            self._requests.close()

    @property
    def port(self) -> int:
        """The UDP port that ``send`` sends from; 0 before the first message."""
        return self.sender.port

    @property
    def numbered(self) -> dict[Sender, Numbers]:
        """The sequences that show losses; not those of ports that several programs share.

        Programs in Java share ports, and their numbers are mixed.
        """
        known = tuple(self.sequences.items())  # may grow meanwhile
        return {s: one for s, one in known if s.port != self._url.port and not one.is_shared}

    def pass_large(self, up_to: int) -> None:
        """Pass only fragmented messages, up to a size [byte], where the system can filter."""
        self._sockets.pass_large(up_to)

    def drops(self) -> int | None:
        """Return the number of datagrams lost here because they were not read fast enough.

        None if it is unknown, or includes datagrams that the filter drops.
        """
        sockets = self._sockets.all
        found = None if self._sockets.is_filtered or len(sockets) > 1 else buffer(sockets[0])
        return found and found.dropped

    def overflows(self) -> int:
        """Return about how many datagrams full buffers have lost so far; 0 if none was full.

        Where filters drop datagrams too, see ``count_overflows``; call it often.
        """
        self._sockets.count_overflows()
        exact = self.drops()
        return self._sockets.overflows if exact is None else exact

    def send(self, channel: str, payload: bytes) -> None:
        """Publish one message, like a separate LCM instance.

        Raises:
            BusError: The system does not send it.
            InvalidName: LCM cannot carry this channel name.
        """
        check_length(channel)
        with os_errors_as(f"cannot send to {self._url.host}", kind=BusError):
            self.sender.send_at_once(channel, payload)

    def receive(self, timeout: float) -> list[Packet]:
        """Return the messages that have arrived, waiting up to ``timeout`` [s] for the first."""
        timeout = max(0.0, timeout)
        # waking up for each message costs more than reading it
        packets = self._read_after_nap(timeout) if self._is_streaming() else []
        if not packets:
            start = time.monotonic()
            has_more = bool(self._sockets.held)
            has_any = bool(self._sockets.ready(0.0 if has_more else timeout))
            is_soon = time.monotonic() - start < _STREAM_GAP
            self._turns = self._turns + has_any if is_soon else 0
            packets = self._read() if has_any or has_more else []
        self._attend_large()
        network_watch.look()
        return packets

    def _read_after_nap(self, longest: float) -> list[Packet]:
        self._sleep(min(self._nap, longest))
        packets = self._read()
        if packets:
            much = max(len(packets) / _OF_A_NAP, self._filled_by(packets) / _FILLED)
            self._nap = min(self.longest_nap, self._nap / max(much, _LITTLE))
        return packets

    def _filled_by(self, packets: Sequence[Packet]) -> float:
        """Return roughly which part of a socket's buffer the short messages among these take."""
        short = sum(map(len, map(_PAYLOAD, packets)))
        if short > SHORT_MESSAGE_MAX:
            sizes = map(len, map(_PAYLOAD, packets))
            short = sum(size for size in sizes if size <= SHORT_MESSAGE_MAX)
        taken = _SHORT_ROOM * len(packets) + _MOST_GROWTH * short
        return taken / (self._sockets.granted * len(self._sockets.short))

    def _sleep(self, seconds: float) -> None:
        """Take a nap; a long one ends when a program requests nodes to announce themselves."""
        if seconds > _DEAF_NAP and self._requests is None:
            from lcmtools.graph.protocol import PROBE_CHANNEL

            try:
                self._requests = ChannelSocket(self._url, PROBE_CHANNEL)
            except BusError:  # this system has no filters
                self.longest_nap = seconds = _DEAF_NAP
        if self._requests is None:
            time.sleep(seconds)
        elif self._requests.wait(seconds):
            self._requests.receive()  # the request also arrives at the tap's own socket

    def _read(self) -> list[Packet]:
        self._sockets.is_stream = self._turns >= _STREAM
        found = self._sockets.read(_BATCH)
        if self._large_only:  # some came before the filter, or there is none
            found = (one for one in found if one[0][:4] == MAGIC_FRAGMENT)
        return self._reader.read_all(found)

    def _attend_large(self) -> None:
        """Let further messages as large as the largest so far pass the filter, and make room."""
        needed = self._reader.largest_whole
        self._sockets.pass_whole(needed)
        if self._is_spread:
            self._sockets.make_room(needed)

    def _is_streaming(self) -> bool:
        """Return whether turns follow each other so closely that a nap pays.

        Never if large messages are assembled and would fill the kernel's buffer, or if a message's
        receive time is the time of reading it.
        """
        sockets = self._sockets
        is_tight = self._is_whole and self._reader.largest_whole > 0 and not sockets.has_room
        is_useful = self.longest_nap and sockets.has_times and not is_tight
        return self._turns >= _STREAM and bool(is_useful)
