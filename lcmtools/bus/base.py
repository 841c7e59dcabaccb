"""The interface of a bus for nodes."""

from collections.abc import Callable, Collection, Sequence
from typing import Protocol

from lcmtools.bus.wakeup import WakeupEvent
from lcmtools.errors import BusError

Handler = Callable[[bytes, int], None]
"""Called with a payload and the time it arrived (nanoseconds since 1970); must be quick."""


class Bus(Protocol):
    """A connection to a bus."""

    on_outage: Callable[[str], None]
    """Called, on the thread that receives, when the connection is lost, and when it is back."""

    on_received: Callable[[], None]
    """Called when another thread than those that ``wait``, or not only one, has called handlers."""

    @property
    def ports(self) -> list[int]:
        """UDP ports that messages come from besides the one of announcements."""

    def publish(
        self, channel: str, payload: bytes, type_name: str = "", *, latched: bool = False
    ) -> None:
        """Send one message. Safe from any thread.

        Args:
            channel: The channel.
            payload: Fingerprint and encoded struct, or any other bytes.
            type_name: The type "package/Name", for a bus whose keys name it; "" if unknown.
            latched: It is state, that may be late; on Zenoh other messages are dropped then.
        """

    def publish_together(self, messages: Sequence[tuple[str, bytes]]) -> Collection[int]:
        """Send those of these messages that cost less together, perhaps in another order.

        Returns the places of the others, which are to be sent one by one. Safe from any thread.
        """

    def subscribe(self, channel: str, handler: Handler) -> None:
        """Call ``handler``, on the thread that receives, for each message on the channel."""

    def unsubscribe(self, channel: str, handler: Handler) -> None:
        """Undo ``subscribe``."""

    def wait(self, wakeup: WakeupEvent, timeout: float | None) -> None:
        """Wait until an event is set, or messages came, for ``timeout`` seconds at most; clear it.

        The calling thread may receive meanwhile; it is to come back soon, or to call ``hand_over``.
        Returns now and then before anything has come.
        """

    def hand_over(self) -> None:
        """Receive without the threads that have called ``wait``, which do something long."""

    def close(self) -> None:
        """Send waiting messages and leave the bus."""

    def leave_to_parent(self) -> None:
        """Refuse all use in a forked process, which has no thread that receives; free nothing."""


def refusal(*, is_of_parent: bool) -> BusError:
    """Return the error of a bus that has been closed, or left to the parent of a forked process."""
    if is_of_parent:
        remedy = "call lcmtools.init() in the forked process and make its nodes there"
        return BusError("the bus belongs to the parent process", remedy)
    return BusError("the bus is closed")
