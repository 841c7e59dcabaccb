"""Reassembling fragmented messages.

Sans-I/O. Fragments may come in any order, twice or never; a sender is any hashable value. Memory is
bounded by the data that have arrived: sizes in headers allocate nothing.
"""

from collections import Counter, OrderedDict
from collections.abc import Hashable

from lcmtools.wire.datagram import Fragment, ShortMessage

_Key = tuple[Hashable, int]

INCOMPLETE = 1_000_000_000
"""[ns] after its latest fragment, an incomplete message is lost."""
_PART_COST = 256  # overhead of keeping a part [byte], so that empty parts count too


class _Incomplete:
    def __init__(self, message_size: int, count: int) -> None:
        self.message_size, self.count = message_size, count
        self.parts: dict[int, Fragment] = {}
        self.kept_bytes = self.latest = 0

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
        self.lost: Counter[str] = Counter()
        """The number of dropped messages by channel, if their first fragment had come."""
        self._incomplete: OrderedDict[_Key, _Incomplete] = OrderedDict()
        self._bytes = 0

    def add(self, sender: Hashable, fragment: Fragment, time: int = 0) -> ShortMessage | None:
        """Add one fragment, which came at a time [ns]; return the message if it is complete."""
        key = (sender, fragment.seqno)
        size, count = fragment.message_size, fragment.count
        message = self._incomplete.get(key)
        if message is None or (message.message_size, message.count) != (size, count):
            self._drop(key)  # the sender's counter wrapped around, or another sender uses it
            message = self._incomplete[key] = _Incomplete(size, count)
        if fragment.number not in message.parts:
            message.parts[fragment.number] = fragment
            message.kept_bytes += len(fragment.part) + _PART_COST
            self._bytes += len(fragment.part) + _PART_COST
        message.latest = time
        self._incomplete.move_to_end(key)
        if len(message.parts) == count:
            self._forget(key)
            return message.whole(fragment.seqno)
        while self._bytes > self.max_bytes or len(self._incomplete) > self.max_messages:
            self._drop(next(iter(self._incomplete)))
        return None

    @property
    def kept_bytes(self) -> int:
        """The bytes of the incomplete messages."""
        return self._bytes

    def has_first(self, sender: Hashable, seqno: int) -> bool:
        """Return whether the first fragment of an incomplete message has come."""
        message = self._incomplete.get((sender, seqno))
        return message is not None and 0 in message.parts

    def drop_before(self, time: int) -> None:
        """Drop the messages of which nothing has come since a time [ns]."""
        while self._incomplete and next(iter(self._incomplete.values())).latest < time:
            self._drop(next(iter(self._incomplete)))

    def _drop(self, key: _Key) -> None:
        message = self._forget(key)
        if message is not None and (first := message.parts.get(0)):
            self.lost[first.channel or ""] += 1

    def _forget(self, key: _Key) -> _Incomplete | None:
        message = self._incomplete.pop(key, None)
        if message is not None:
            self._bytes -= message.kept_bytes
        return message
