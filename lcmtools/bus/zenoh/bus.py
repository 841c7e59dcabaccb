"""The bus of nodes on Zenoh: calling handlers for the messages that a session receives.

Zenoh's own threads queue messages; the handlers run where ``ReceivingBus`` calls them.
"""

from collections.abc import Callable, Mapping, Sequence

from lcmtools.bus.receiving_bus import ReceivingBus
from lcmtools.bus.url import BusUrl
from lcmtools.bus.zenoh.session import ZenohSession
from lcmtools.names import check_length


class ZenohBus(ReceivingBus):
    """A Zenoh session with its own receiving thread; see ``Bus``.

    The session handles forks itself.

    Raises:
        BusError: The bus cannot be reached; the error says what to do.
        MissingExtra: Zenoh is not installed.
    """

    def __init__(self, url: BusUrl) -> None:
        super().__init__(url)
        self._session = ZenohSession(url, lambda text, _trouble: self.on_outage(text))
        self._start()

    def publish(
        self, channel: str, payload: bytes, type_name: str = "", *, latched: bool = False
    ) -> None:
        """Send one message, as in ``Bus``, with its type in the key and whether it may be late."""
        check_length(channel)
        if self._closed:
            raise self._refusal()
        self._session.publish(channel, payload, type_name, latched=latched)

    def dropped(self) -> tuple[str, Mapping[str, int]]:
        """Return the end of a full line, and the number of messages that were not sent."""
        return " and ".join(self._session.sender.full_lines()), self._session.dropped_of()

    def _on_receiver(self, work: Callable[[], None]) -> None:
        """Do it at once: a session is used by any thread."""
        with self._changing:
            if self._closed:
                raise self._refusal()
            work()

    def _begin(self, channel: str) -> None:
        self._session.subscribe(channel)

    def _end(self, channel: str) -> None:
        self._session.unsubscribe(channel)

    def _descriptors(self) -> Sequence[int]:
        return (self._session.fileno(),)

    def _receive(self, most: int) -> int:
        packets = self._session.receive(most)
        for packet in packets:
            self._dispatch(packet.channel, packet.payload, packet.time)
        return len(packets)

    def _leave(self) -> None:
        self._session.close()
