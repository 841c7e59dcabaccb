"""The tap: a passive observer of a multicast group's datagrams.

It joins the group beside everyone else and sees every sender, whether or not that program has
ever heard of lcmtools. It decodes nothing, and no datagram makes it fail.
"""

import contextlib
import select
import socket
import struct
import time

from lcmtools.bus.multicast import check_multicast, receiving_socket, sending_socket
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.names import check_length
from lcmtools.wire.datagram import (
    Malformed,
    ShortMessage,
    fits_datagram,
    fragments,
    parse,
    short_message,
)
from lcmtools.wire.packet import Packet, Sender
from lcmtools.wire.reassembly import Reassembler

_SO_TIMESTAMPNS = 35  # asm-generic/socket.h; Python's socket module does not name it
_TIMESPEC = struct.Struct("@qq")
_MAX_DATAGRAM = 65536
_MOST_MALFORMED = 1000  # senders that are remembered
_BATCH = 256  # datagrams taken at once before the caller is served


class Tap:
    """An observer of one multicast group.

    Raises:
        BusError: Multicast does not work here, with what to type.
    """

    def __init__(self, url: BusUrl) -> None:
        check_multicast(url)
        self._address = (url.host, url.port)
        self._receiver = receiving_socket(url)
        self._receiver.settimeout(0.0)
        self._sender = sending_socket(url)
        self._seqno = 0
        self._reassembler = Reassembler()
        self.malformed: dict[Sender, str] = {}
        """The last reason for each sender whose datagrams could not be read."""
        _ask_kernel_for_times(self._receiver)

    def __enter__(self) -> "Tap":
        """Use the tap as a context manager."""
        return self

    def __exit__(self, *_: object) -> None:
        """Leave the group."""
        self.close()

    def close(self) -> None:
        """Leave the group."""
        self._receiver.close()
        self._sender.close()

    @property
    def port(self) -> int:
        """The UDP port that ``send`` sends from; 0 before the first."""
        return int(self._sender.getsockname()[1])

    def send(self, channel: str, payload: bytes) -> None:
        """Publish one message, as an LCM instance of its own.

        Raises:
            BusError: The system does not let it out.
            InvalidName: LCM cannot carry this channel name.
        """
        check_length(channel)
        self._seqno += 1
        try:
            if fits_datagram(channel, payload):
                datagram = short_message(self._seqno, channel, payload)
                self._sender.sendto(datagram, self._address)
                return
            for datagram in fragments(self._seqno, channel, payload):
                self._sender.sendto(datagram, self._address)
        except OSError as error:
            raise BusError(f"cannot send to {self._address[0]}: {error.strerror}") from error

    def receive(self, timeout: float) -> list[Packet]:
        """The messages that have arrived, waiting up to ``timeout`` seconds for the first."""
        if not select.select([self._receiver], [], [], max(0.0, timeout))[0]:
            return []
        packets: list[Packet] = []
        for _ in range(_BATCH):
            try:
                data, ancillary, _, address = self._receiver.recvmsg(_MAX_DATAGRAM, 64)
            except BlockingIOError:
                break
            packet = self._read(data, Sender(*address), _arrival(ancillary))
            if packet is not None:
                packets.append(packet)
        return packets

    def _read(self, data: bytes, sender: Sender, arrival: int) -> Packet | None:
        """The message that this datagram completes, if it does."""
        message = parse(data)
        if isinstance(message, Malformed):
            if len(self.malformed) < _MOST_MALFORMED or sender in self.malformed:
                self.malformed[sender] = message.reason
            return None
        if not isinstance(message, ShortMessage):
            whole = self._reassembler.add(sender, message)
            if whole is None:
                return None
            message = whole
        return Packet(message.channel, message.payload, arrival, sender, message.seqno)


def _ask_kernel_for_times(receiver: socket.socket) -> None:
    with contextlib.suppress(OSError):  # not Linux: the time of reading serves instead
        receiver.setsockopt(socket.SOL_SOCKET, _SO_TIMESTAMPNS, 1)


def _arrival(ancillary: list[tuple[int, int, bytes]]) -> int:
    """The kernel's receive time, nanoseconds since 1970; the present where it tells none."""
    for level, kind, data in ancillary:
        if level == socket.SOL_SOCKET and kind == _SO_TIMESTAMPNS and len(data) >= _TIMESPEC.size:
            seconds, nanoseconds = _TIMESPEC.unpack_from(data)
            return int(seconds) * 1_000_000_000 + int(nanoseconds)
    return time.time_ns()
