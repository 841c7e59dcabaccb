"""Putting fragmented messages together again.

Sans-I/O. Fragments may come in any order, twice, or never; a sender is any hashable value.
Memory is bounded by what has really arrived: a header's claim allocates nothing.
"""

from collections import OrderedDict
from collections.abc import Hashable
from dataclasses import dataclass, field

from lcmtools.wire.datagram import Fragment, ShortMessage

_Key = tuple[Hashable, int]

_PART_COST = 256  # bytes that keeping a part takes beside its own, so that empty parts count too


@dataclass(slots=True)
class _Incomplete:
    message_size: int
    count: int
    channel: str | None = None
    parts: dict[int, Fragment] = field(default_factory=dict)
    kept_bytes: int = 0

    def add(self, fragment: Fragment) -> None:
        if fragment.number in self.parts:
            return
        self.parts[fragment.number] = fragment
        self.kept_bytes += len(fragment.part) + _PART_COST
        if fragment.channel is not None:
            self.channel = fragment.channel

    def payload(self) -> bytes | None:
        """Return the whole payload; None if the parts do not join without gap or overlap."""
        position = 0
        ordered = [self.parts[number] for number in range(self.count)]
        for fragment in ordered:
            if fragment.offset != position:
                return None
            position += len(fragment.part)
        return b"".join(f.part for f in ordered) if position == self.message_size else None


class Reassembler:
    """Collects fragments into messages, forgetting the least recently touched when full.

    Args:
        max_bytes: Bytes of incomplete messages that are kept (liblcm: 16 MiB).
        max_messages: Incomplete messages that are kept (liblcm: 1000).
    """

    def __init__(self, max_bytes: int = 64 << 20, max_messages: int = 1000) -> None:
        self.max_bytes = max_bytes
        self.max_messages = max_messages
        self.discarded = 0
        """Messages given up: inconsistent, or pushed out by newer ones."""
        self._incomplete: OrderedDict[_Key, _Incomplete] = OrderedDict()
        self._bytes = 0

    def add(self, sender: Hashable, fragment: Fragment) -> ShortMessage | None:
        """Take one fragment; return the message when it is complete."""
        key = (sender, fragment.seqno)
        message = self._incomplete.get(key)
        if message is None or not _belongs(message, fragment):
            self._forget(key)  # the sender's counter wrapped, or the sender is another one
            message = _Incomplete(fragment.message_size, fragment.count)
            self._incomplete[key] = message
        before = message.kept_bytes
        message.add(fragment)
        self._bytes += message.kept_bytes - before
        self._incomplete.move_to_end(key)
        if len(message.parts) == message.count:
            return self._complete(key, message)
        self._bound()
        return None

    def _complete(self, key: _Key, message: _Incomplete) -> ShortMessage | None:
        del self._incomplete[key]
        self._bytes -= message.kept_bytes
        payload = message.payload()
        if payload is None or message.channel is None:
            self.discarded += 1
            return None
        return ShortMessage(key[1], message.channel, payload)

    def _bound(self) -> None:
        while self._bytes > self.max_bytes or len(self._incomplete) > self.max_messages:
            self._forget(next(iter(self._incomplete)))

    def _forget(self, key: _Key) -> None:
        message = self._incomplete.pop(key, None)
        if message is not None:
            self._bytes -= message.kept_bytes
            self.discarded += 1


def _belongs(message: _Incomplete, fragment: Fragment) -> bool:
    return message.message_size == fragment.message_size and message.count == fragment.count
