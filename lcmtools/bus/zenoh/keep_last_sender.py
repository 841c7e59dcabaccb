"""A sender for a network that may be slower than its publishers: the newest messages wait.

Up to 64 kB of each topic wait, or one message: hundreds of commands, but only the newest image. The
oldest make room, so that no publisher waits and no old messages are sent.
"""

from collections import deque
from collections.abc import Callable
from typing import NamedTuple

from lcmtools.bus.sending_thread import SendingThread

MOST_WAITING_BYTES = 64_000  # bytes of a topic's waiting messages; a single one may always wait


class Outgoing(NamedTuple):
    """A message on its way: its key, payload and attachment."""

    key: str
    payload: bytes
    stamp: bytes
    is_large: bool


class KeepLastSender(SendingThread[Outgoing]):
    """Waiting messages, which are sent one after another, each topic in its turn.

    ``put`` sends a message; it may take long, and must not raise.
    """

    def __init__(self, put: Callable[[Outgoing], None]) -> None:
        super().__init__("keep-last sender")
        self._put = put
        self.dropped = 0  # messages dropped to make room for newer ones of their topic
        self._waiting: dict[str, deque[Outgoing]] = {}
        self._sending = ""  # the key of the message that is being sent

    def add(self, message: Outgoing) -> None:
        """Queue a message; drop the oldest of its topic if there is no room."""
        with self._changed:
            self._start()
            queue = self._waiting.setdefault(message.key, deque())
            queue.append(message)
            while len(queue) > 1 and sum(len(one.payload) for one in queue) > MOST_WAITING_BYTES:
                queue.popleft()
                self.dropped += 1
            self._changed.notify_all()

    def has_waiting(self, key: str) -> bool:
        """Return whether a message of this topic waits or is being sent: none may overtake it."""
        return key in self._waiting or key == self._sending

    def await_sent(self, key: str) -> None:
        """Wait until no message of this topic waits or is being sent, or this is closed."""
        with self._changed:
            self._changed.wait_for(lambda: self._closed or not self.has_waiting(key))

    def _next(self) -> Outgoing | None:
        """Pop the first message of the topic that has waited longest for its turn."""
        if not self._waiting:
            return None
        key = next(iter(self._waiting))
        queue = self._waiting.pop(key)
        message = queue.popleft()
        self._sending = key
        if queue:
            self._waiting[key] = queue
        return message

    def _send_now(self, message: Outgoing) -> None:
        self._put(message)

    def _note_sent(self, message: Outgoing) -> None:  # noqa: ARG002 - only one is being sent
        self._sending = ""
