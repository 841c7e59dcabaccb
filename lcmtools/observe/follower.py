"""The whole messages of one channel, for as long as somebody looks at it closely.

The table does with the heads of large messages; so beside it a second observer takes in one
channel whole, on a thread of its own.
"""

import threading
from collections.abc import Callable
from contextlib import suppress

from lcmtools.bus.tap import Tap
from lcmtools.bus.url import BusUrl
from lcmtools.errors import BusError
from lcmtools.wire.packet import Packet

_WAIT = 0.1  # [s] at most before it sees that it is to end
_AGAIN = 0.5  # [s] before a network that fails is tried again


class Follower:
    """Reads one channel of a multicast bus.

    Args:
        url: The bus.
        channel: The channel.
        hear: Is given its packets, on the follower's thread.
    """

    def __init__(self, url: BusUrl, channel: str, hear: Callable[[Packet], None]) -> None:
        self._url = url
        self._channel = channel
        self._hear = hear
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._run, name="spy follower", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Read no more."""
        self._ends.set()

    def _run(self) -> None:
        while not self._ends.is_set():
            # the table says what is wrong with the network
            with suppress(BusError, OSError), Tap(self._url, always_whole=(self._channel,)) as tap:
                self._read(tap)
            self._ends.wait(_AGAIN)

    def _read(self, tap: Tap) -> None:
        while not self._ends.is_set():
            for packet in tap.receive(_WAIT):
                if packet.channel == self._channel:
                    self._hear(packet)
