"""The condition on which a snapshot is written."""

from collections.abc import Callable, Sequence

from lcmtools.errors import LcmtoolsError, UsageError
from lcmtools.messages.filter import Filter
from lcmtools.names import Resolver
from lcmtools.observe.decoding import Decoder
from lcmtools.wire.packet import Packet


class Trigger:
    """A condition on messages of a topic, "/estop m.data"; UsageError for a text that is none."""

    def __init__(
        self, text: str, names: Resolver, announced: Callable[[str], Sequence[str]]
    ) -> None:
        topic, _, condition = text.strip().partition(" ")
        if not condition.strip():
            raise UsageError(f"'{text}' has no condition", "write '/estop m.data'")
        self._channels = names.spellings(topic)
        self._filter = Filter(condition.strip())
        self._decoder = Decoder(announced)

    def __call__(self, packet: Packet) -> bool:
        """Return whether a message meets the condition; False for one of an unknown type."""
        if packet.channel not in self._channels:
            return False
        try:
            return self._filter.matches(self._decoder.decode(packet))
        except LcmtoolsError:
            return False
