"""Reading datagrams: their messages, and the losses and faults of their senders.

Sans-I/O: bytes, senders and times come in as arguments, and no datagram makes it fail.
"""

import struct
from collections.abc import Iterable

from lcmtools.bounded import MOST_ENTRIES, BoundedDict
from lcmtools.names import SELF_TEST_CHANNEL
from lcmtools.wire.datagram import (
    FRAGMENT_HEADER_BYTES,
    MAGIC_FRAGMENT,
    Fragment,
    MalformedDatagram,
    parse,
    split_short,
)
from lcmtools.wire.packet import Datagram, Packet, Sender
from lcmtools.wire.reassembly import Reassembler
from lcmtools.wire.sequence import Sequence

HEAD_BYTES = 1024
"""Size of the head of a large message's payload."""

PROTOCOL_PREFIX = "/_lcmtools/"
"""The prefix of the channels of announcements and probes, which are read whole."""

_number = struct.Struct(">4xI").unpack_from  # the sequence number of a message
_new = tuple.__new__  # creates a named tuple in half the time


class Reader:
    """Reads the datagrams of one bus.

    Args:
        whole: Assemble large messages; else return only their heads (``Packet.whole_bytes``).
        always_whole: Prefixes of channels whose messages are assembled anyway.
    """

    def __init__(self, *, whole: bool, always_whole: tuple[str, ...] = (PROTOCOL_PREFIX,)) -> None:
        self._always_whole = ("",) if whole else always_whole
        self._whole = whole
        self._reassembler = Reassembler()
        self._channels: dict[bytes, str] = {}  # cleared when full: a look-up is all that it saves
        self.needs_all = whole
        """True if it needs more than the first fragment of messages."""
        self.largest_whole = 0
        """The size of the largest fragmented message on channels that are assembled [byte]."""
        self.malformed = BoundedDict[Sender, str]()
        """The last error of each sender whose datagrams could not be read."""
        self.sequences = BoundedDict[Sender, Sequence]()
        """Each sender's sequence numbers, which show its losses."""
        self.ttls = BoundedDict[Sender, int]()
        """Each sender's time to live: the number of routers that its datagrams may pass."""

    def read(self, data: bytes, sender: Sender, time: int, ttl: int | None = None) -> Packet | None:
        """Return the message that this datagram completes, or whose head it has, if any."""
        return next(iter(self.read_all([(data, sender, time, ttl)])), None)

    def read_all(self, datagrams: Iterable[Datagram]) -> list[Packet]:
        """Return the messages that these datagrams complete, or whose heads they have."""
        packets, before, known_ttl = [], None, None
        channels, split, number = self._channels.get, split_short, _number
        for data, sender, time, ttl in datagrams:
            name, payload = split(data)
            if payload is not None:
                (seqno,) = number(data)
                channel = channels(name) or self._decode_channel(name)
                packet = _new(Packet, (channel, payload, time, sender, seqno, None, None, ""))
            else:
                other = self._read_other(data, sender, time)
                if other is None:
                    continue
                packet, seqno = other
            packets.append(packet)
            if sender is not before:
                before, known_ttl = sender, self.ttls.get(sender)
                sequence = self.sequences.use(sender) or self._sequence(sender)
            sequence.add(seqno)
            if ttl != known_ttl and ttl is not None and packet.channel != SELF_TEST_CHANNEL:
                known_ttl = ttl
                self.ttls[sender] = ttl
        return packets

    def _read_other(self, data: bytes, sender: Sender, time: int) -> tuple[Packet, int] | None:
        """Read a fragment or malformed datagram; return a message, if any, and its number."""
        if data[:4] == MAGIC_FRAGMENT and not self.needs_all and _is_later(data):
            return None
        message = parse(data)
        if isinstance(message, Fragment):
            joined = self._join(message, sender, time)
            return joined and (joined, message.seqno)
        if isinstance(message, MalformedDatagram):
            self.malformed[sender] = message.reason
        return None

    def _decode_channel(self, name: bytes) -> str:
        """Return the channel for encoded bytes; cached, because a stream repeats one name."""
        channel = name.decode("utf-8", "surrogateescape")
        if len(self._channels) >= MOST_ENTRIES:
            self._channels.clear()
        self._channels[name] = channel
        return channel

    def _join(self, fragment: Fragment, sender: Sender, time: int) -> Packet | None:
        channel, seqno = fragment.channel, fragment.seqno
        if channel is None:
            if not (self._whole or self._reassembler.has_first(sender, seqno)):
                return None
        elif not channel.startswith(self._always_whole):
            head = bytes(fragment.part[:HEAD_BYTES])
            return Packet(channel, head, time, sender, seqno, fragment.message_size)
        self.needs_all = True
        self.largest_whole = max(self.largest_whole, fragment.message_size)
        if channel is not None or sender in self.sequences:  # else begun before this
            self._sequence(sender).begin(seqno)
        whole = self._reassembler.add(sender, fragment, time)
        return whole and Packet(whole.channel, whole.payload, time, sender, seqno)

    def _sequence(self, sender: Sender) -> Sequence:
        """Return a sender's sequence."""
        known = self.sequences.use(sender)
        if known is None:
            known = self.sequences[sender] = Sequence()
        return known


def _is_later(fragment: bytes) -> bool:
    # the same condition as in the kernel's filter
    return len(fragment) >= FRAGMENT_HEADER_BYTES and fragment[16:18] != b"\0\0"
