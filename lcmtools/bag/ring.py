"""The messages that are kept in memory for a snapshot, and the condition for writing them."""

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from lcmtools.clock import NANOSECONDS
from lcmtools.errors import LcmtoolsError, UsageError, ValueMismatch
from lcmtools.messages.filter import Filter
from lcmtools.names import Resolver
from lcmtools.observe.reading.decoding import Decoder
from lcmtools.wire.packet import Packet


@dataclass(frozen=True, slots=True)
class SnapshotPlan:
    """Options for a recording that is kept in memory until a snapshot is requested."""

    before: float  # [s] for which messages are kept
    after: float = 0.0  # [s] for which recording continues after a request
    most_bytes: int | None = None  # of kept payloads; None for no limit
    is_wanted: Callable[[Packet], bool] | None = None  # True for a message that requests a snapshot


class Trigger:
    """A condition on messages of a topic, "/estop m.data"; UsageError for an invalid text."""

    def __init__(
        self, text: str, names: Resolver, announced: Callable[[str], Sequence[str]]
    ) -> None:
        topic, _, condition = text.strip().partition(" ")
        if not condition.strip():
            raise UsageError(f"'{text}' has no condition", "write '/estop m.data'")
        self._channels = names.spellings(topic)
        self._filter = Filter(condition.strip())
        self._decoder = Decoder(announced)
        self._has_fitted = False

    def __call__(self, packet: Packet) -> bool:
        """Return whether a message meets the condition; False for one of an unknown type.

        Raises:
            ValueMismatch: A field or a value's type in it does not fit the first message.
        """
        if packet.channel not in self._channels:
            return False
        try:
            message = self._decoder.decode(packet)
        except LcmtoolsError:
            return False
        try:
            is_met = self._filter.matches(message)
        except ValueMismatch:
            if self._has_fitted:  # messages of another type may come on the topic
                return False
            raise
        self._has_fitted = True
        return is_met


class Ring:
    """The latest messages, kept in memory."""

    def __init__(self, snapshot: SnapshotPlan) -> None:
        self._before = round(snapshot.before * NANOSECONDS)
        self._most = snapshot.most_bytes
        self.packets: deque[Packet] = deque()  # the messages, the oldest first
        self.bytes = 0  # bytes of their payloads

    def add(self, packets: Sequence[Packet], now: int) -> list[Packet]:
        """Add messages; return those that are too old at the time ``now`` [ns], or too many."""
        dropped: list[Packet] = []
        kept = self.packets
        kept.extend(packets)
        self.bytes += sum(packet.size for packet in packets)
        while kept and (kept[0].time < now - self._before or self._is_too_large):
            self.bytes -= kept[0].size
            dropped.append(kept.popleft())
        return dropped

    @property
    def _is_too_large(self) -> bool:
        return self._most is not None and self.bytes > self._most
