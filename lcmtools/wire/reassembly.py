"""Reassembling fragmented messages.

Sans-I/O. Fragments may come in any order, twice or never; a sender is any hashable value. Memory is
bounded by the data that have arrived: sizes in headers allocate nothing.
"""

from collections import Counter, OrderedDict
from collections.abc import Callable, Hashable

from lcmtools.bounded import BoundedDict
from lcmtools.wire.datagram import Fragment, ShortMessage

_Key = tuple[Hashable, int]

INCOMPLETE = 1_000_000_000
"""[ns] after its latest fragment, an incomplete message is lost."""
# fragments of one port and size within a period; further ones are to be dropped
_MOST_UNWANTED = 40
_PERIOD = 200_000_000  # [ns]
_MOST_DENIED = 16
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
        wants: Returns whether the messages of a channel are wanted; others are not collected.
        max_bytes: Bytes of incomplete messages to keep (liblcm: 16 MiB).
        max_messages: Number of incomplete messages to keep (liblcm: 1000).
        max_early_bytes: While this much is kept, fragments are ignored whose first one, with the
            channel, has not come.
    """

    def __init__(
        self,
        wants: Callable[[str], bool] = lambda _: True,
        *,
        max_bytes: int = 64 << 20,
        max_messages: int = 1000,
        max_early_bytes: int = 64 << 20,
    ) -> None:
        self._wants = wants
        self._max_early_bytes = max_early_bytes
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
        self.drop_before(time - INCOMPLETE)
        message = self._incomplete.get(key)
        if fragment.channel is None:
            is_early = message is None or 0 not in message.parts
            if is_early and self._bytes >= self._max_early_bytes:
                return None
        elif not self._wants(fragment.channel):
            self._forget(key)
            return None
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


class UnwantedMessages:
    """Large messages that a program receives without wanting them, to be dropped in the kernel.

    Only the first fragment of a message names its channel, so all others pass the kernel's filter,
    and images for other programs would cost more than a node's own messages. If many fragments come
    whose first one was dropped, those of the same port and size are to be dropped.

    Attributes:
        denied: Their source ports and sizes.
    """

    def __init__(self) -> None:
        self.denied: list[tuple[int, int]] = []
        # when counting began [ns], and the number of fragments
        self._counts = BoundedDict[tuple[int, int], tuple[int, int]]()
        self._wanted = BoundedDict[int, None]()  # ports; as a set

    def note(self, port: int, size: int, now: int) -> bool:
        """Count a fragment without a first one [ns]; return whether ``denied`` has changed."""
        if port in self._wanted or (port, size) in self.denied:
            return False
        began, count = self._counts.pop((port, size), (now, 0))
        if not 0 <= now - began <= _PERIOD:
            began, count = now, 0
        if count >= _MOST_UNWANTED:
            self.denied = [*self.denied[1 - _MOST_DENIED :], (port, size)]
            return True
        self._counts[port, size] = began, count + 1
        return False

    def want(self, port: int) -> bool:
        """Never drop messages from this port; return whether ``denied`` has changed."""
        self._wanted[port] = None
        before, self.denied = self.denied, [one for one in self.denied if one[0] != port]
        return before != self.denied

    def clear(self) -> bool:
        """Forget what was unwanted, because other channels are wanted now; return as ``want``."""
        self._counts.clear()
        before, self.denied = self.denied, []
        return bool(before)
