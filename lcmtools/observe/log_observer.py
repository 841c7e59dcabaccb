"""A log as something to observe, read at once: for ``watch``, in place of a bus."""

from itertools import islice

from lcmtools.bus.url import BusUrl
from lcmtools.observe.log_file import read_log
from lcmtools.wire.packet import Packet

_BATCH = 100  # messages at a time, so that who reads can stop


class LogObserver:
    """The messages of a log, as fast as they are asked for; their time is when they were recorded.

    Args:
        path: The file.
    """

    port = 0

    def __init__(self, path: str) -> None:
        self.url = BusUrl("file", path)
        self._packets = read_log(self.url)

    def receive(self, timeout: float) -> list[Packet]:  # noqa: ARG002 - a log never waits
        """The next messages.

        Raises:
            EOFError: The log has ended.
            BusError: The file cannot be read.
        """
        packets = list(islice(self._packets, _BATCH))
        if not packets:
            raise EOFError
        return packets

    def send(self, channel: str, payload: bytes) -> None:
        """Nobody can hear: nothing is sent."""

    def close(self) -> None:
        """Close the file."""
        self._packets = iter(())
