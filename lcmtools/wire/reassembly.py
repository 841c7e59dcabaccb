"""Reassembling fragmented messages.

Sans-I/O. Fragments may come in any order, twice or never; a sender is any hashable value. Memory is
bounded by the data that have arrived: sizes in headers allocate nothing.
"""

from collections import OrderedDict
from collections.abc import Hashable

from lcmtools.wire.datagram import Fragment, ShortMessage

_Key = tuple[Hashable, int]

_PART_COST = 256  # overhead of keeping a part [byte], so that empty parts count too


class _Incomplete:
    def __init__(self, message_size: int, count: int) -> None:
        self.message_size, self.count = message_size, count
        self.parts: dict[int, Fragment] = {}
        self.kept_bytes = 0

    def whole(self, seqno: int) -> ShortMessage | None:
        """Return the message; None if the parts do not join without gap or overlap."""
        ordered = [self.parts[number] for number in range(self.count)]
        channel, position = ordered[0].channel, 0
        for fragment in ordered:
            if fragment.offset != position:
                return None
            position += len(fragment.part)
        if channel is None or position != self.message_size:
            return None
        return ShortMessage(seqno, channel, b"".join(fragment.part for fragment in ordered))


class Reassembler:
    """Collects fragments into messages, and drops the least recently touched when full.

    Args:
        max_bytes: Bytes of incomplete messages to keep (liblcm: 16 MiB).
        max_messages: Number of incomplete messages to keep (liblcm: 1000).
    """

    def __init__(self, max_bytes: int = 64 << 20, max_messages: int = 1000) -> None:
        self.max_bytes = max_bytes
        self.max_messages = max_messages
        self._incomplete: OrderedDict[_Key, _Incomplete] = OrderedDict()
        self._bytes = 0

    def add(self, sender: Hashable, fragment: Fragment) -> ShortMessage | None:
        """Add one fragment; return the message if it is complete."""
        key = (sender, fragment.seqno)
        size, count = fragment.message_size, fragment.count
        message = self._incomplete.get(key)
        if message is None or (message.message_size, message.count) != (size, count):
            self._forget(key)  # the sender's counter wrapped around, or another sender uses it
            message = self._incomplete[key] = _Incomplete(size, count)
        if fragment.number not in message.parts:
            message.parts[fragment.number] = fragment
            message.kept_bytes += len(fragment.part) + _PART_COST
            self._bytes += len(fragment.part) + _PART_COST
        self._incomplete.move_to_end(key)
        if len(message.parts) == count:
            self._forget(key)
            return message.whole(fragment.seqno)
        while self._bytes > self.max_bytes or len(self._incomplete) > self.max_messages:
            self._forget(next(iter(self._incomplete)))
        return None

    def _forget(self, key: _Key) -> None:
        message = self._incomplete.pop(key, None)
        if message is not None:
            self._bytes -= message.kept_bytes
