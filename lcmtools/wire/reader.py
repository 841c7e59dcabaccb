"""From datagrams to messages, with what they tell of their senders on the way.

Sans-I/O: bytes, senders and times come in as arguments, and no datagram makes it fail.
"""

from lcmtools.wire.datagram import (
    FRAGMENT_HEADER_BYTES,
    MAGIC_FRAGMENT,
    Fragment,
    Malformed,
    ShortMessage,
    parse,
)
from lcmtools.wire.packet import Packet, Sender
from lcmtools.wire.reassembly import Reassembler
from lcmtools.wire.sequence import Sequence

HEAD_BYTES = 1024
"""So much is kept of a large message's payload where its head is enough."""

TALK = "/_lcmtools/"
"""The prefix of the channels of announcements and probes; they are read whole."""

_MOST_SENDERS = 1000  # that are remembered


class Reader:
    """Reads the datagrams of one bus.

    Args:
        whole: Put large messages together; else their heads come (``Packet.whole_bytes``).
        always_whole: Channels that begin so come whole nevertheless.
    """

    def __init__(self, *, whole: bool, always_whole: tuple[str, ...] = (TALK,)) -> None:
        self._whole = whole
        self._always_whole = always_whole
        self._reassembler = Reassembler()
        self._wanted: dict[tuple[Sender, int], None] = {}
        self.needs_all = whole
        """True if it has use for fragments that are not the first of their message."""
        self.largest_wanted = 0
        """Bytes of the largest message so far that is wanted whole where heads do otherwise."""
        self.malformed: dict[Sender, str] = {}
        """The last reason for each sender whose datagrams could not be read."""
        self.sequences: dict[Sender, Sequence] = {}
        """Each sender's sequence of numbers, which shows its losses."""
        self.ttls: dict[Sender, int] = {}
        """Each sender's time to live: the routers that its datagrams may pass, 0 for none."""

    def read(self, data: bytes, sender: Sender, time: int, ttl: int | None = None) -> Packet | None:
        """The message that this datagram completes, or whose head it is, if it does.

        Args:
            data: The datagram.
            sender: Where it came from.
            time: When it came, nanoseconds since 1970.
            ttl: Its time to live, where that is known.
        """
        if not self.needs_all and _is_later_fragment(data):
            return None
        message = parse(data)
        if isinstance(message, Malformed):
            if len(self.malformed) < _MOST_SENDERS or sender in self.malformed:
                self.malformed[sender] = message.reason
            return None
        if isinstance(message, ShortMessage):
            packet = Packet(message.channel, message.payload, time, sender, message.seqno)
        else:
            found = self._join(message, sender, time)
            if found is None:
                return None
            packet = found
        self._count(sender, message.seqno, ttl)
        return packet

    def _join(self, fragment: Fragment, sender: Sender, time: int) -> Packet | None:
        channel, seqno = fragment.channel, fragment.seqno
        if not (self._whole or self._is_wanted(fragment, sender)):
            if channel is None:
                return None
            head = fragment.part[:HEAD_BYTES]
            return Packet(channel, head, time, sender, seqno, fragment.message_size)
        if channel is not None or sender in self.sequences:  # else it had begun before
            self._sequence(sender).begin(seqno)
        whole = self._reassembler.add(sender, fragment)
        if whole is None:
            return None
        self._wanted.pop((sender, seqno), None)
        return Packet(whole.channel, whole.payload, time, sender, seqno)

    def _is_wanted(self, fragment: Fragment, sender: Sender) -> bool:
        """Return whether this is of a message that is wanted whole however large it is."""
        key = (sender, fragment.seqno)
        if fragment.channel is None or not fragment.channel.startswith(self._always_whole):
            return fragment.channel is None and key in self._wanted
        self.needs_all = True
        self.largest_wanted = max(self.largest_wanted, fragment.message_size)
        if len(self._wanted) >= _MOST_SENDERS:
            self._wanted.pop(next(iter(self._wanted)))
        self._wanted[key] = None
        return True

    def _count(self, sender: Sender, seqno: int, ttl: int | None) -> None:
        self._sequence(sender).add(seqno)
        if ttl is not None and sender in self.sequences:
            self.ttls[sender] = ttl

    def _sequence(self, sender: Sender) -> Sequence:
        """A sender's sequence; beyond a thousand senders none is kept."""
        known = self.sequences.get(sender)
        if known is None:
            known = Sequence()
            if len(self.sequences) < _MOST_SENDERS:
                self.sequences[sender] = known
        return known


def _is_later_fragment(data: bytes) -> bool:
    """True if a filter in the kernel would have dropped it, which also knows no more than this."""
    return (
        data[:4] == MAGIC_FRAGMENT and len(data) >= FRAGMENT_HEADER_BYTES and data[16:18] != b"\0\0"
    )
