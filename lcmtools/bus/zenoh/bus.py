"""The bus of nodes on Zenoh: calling handlers for the messages that a session receives.

Zenoh's own threads queue messages; the handlers run where ``ReceivingBus`` calls them.
"""

from collections.abc import Collection, Sequence

from lcmtools.bus.base import Handler
from lcmtools.bus.receiving_bus import ReceivingBus
from lcmtools.bus.url import BusUrl
from lcmtools.bus.zenoh.session import ZenohSession
from lcmtools.names import check_channel, check_length


class ZenohBus(ReceivingBus):
    """A Zenoh session with its own receiving thread; see ``Bus``.

    The session handles forks itself.

    Raises:
        BusError: The bus cannot be reached; the error says what to do.
        MissingExtra: Zenoh is not installed.
    """

    ports: list[int] = []  # noqa: RUF012 - none: see ``Bus``

    def __init__(self, url: BusUrl) -> None:
        super().__init__(url)
        self._session = ZenohSession(url, lambda text, _trouble: self.on_outage(text))
        self._start()

    def publish(
        self, channel: str, payload: bytes, type_name: str = "", *, latched: bool = False
    ) -> None:
        """Send one message; see ``Bus.publish``.

        Raises:
            BusError: The bus is closed.
            InvalidName: LCM cannot carry this channel name.
        """
        check_length(channel)
        if self._closed:
            raise self._refusal()
        self._session.publish(channel, payload, type_name, latched=latched)

    def publish_together(self, messages: Sequence[tuple[str, bytes]]) -> Collection[int]:
        """Send none together (see ``Bus``)."""
        return range(len(messages))

    def subscribe(self, channel: str, handler: Handler) -> None:
        """Call ``handler`` for each message on this channel.

        Raises:
            BusError: The bus is closed.
            InvalidName: LCM cannot carry this channel name.
        """
        check_channel(channel)
        with self._changing:
            if self._closed:
                raise self._refusal()
            is_first = channel not in self._handlers
            self._add_handler(channel, handler)
            if is_first:
                self._session.subscribe(channel)

    def unsubscribe(self, channel: str, handler: Handler) -> None:
        """Undo ``subscribe``."""
        with self._changing:
            self._remove_handler(channel, handler)
            if channel not in self._handlers and not self._closed:
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
