"""The replies that a service has sent: a repeated request is answered by one, not executed again.

Must not know messages or the bus.
"""

from collections import OrderedDict
from dataclasses import dataclass

BYTES_A_SECOND = 20e6
"""So fast at least large messages travel: until then none is sent again."""
_MOST_REQUESTS = 10_000
"""Requests that are known to be answered; a repeated one of before would be executed again."""
_MOST_BYTES = 64 << 20
"""Of replies that can be repeated; where they are more, the oldest are forgotten."""
Key = tuple[str, int]
"""A client and the number of its request."""


@dataclass(slots=True)
class _Reply:
    payload: bytes | None  # None once forgotten
    arrives: float  # time from which a repeated request means that it was lost [s]


class Replies:
    """The latest replies of one service."""

    def __init__(self) -> None:
        self._replies: OrderedDict[Key, _Reply] = OrderedDict()
        self._with_payload: OrderedDict[Key, int] = OrderedDict()
        self._bytes = 0

    def __contains__(self, key: Key) -> bool:
        """Return whether a request has been answered."""
        return key in self._replies

    def add(self, key: Key, payload: bytes) -> None:
        """Remember a reply."""
        self._replies[key] = _Reply(payload, 0.0)
        self._with_payload[key] = len(payload)
        self._bytes += len(payload)
        while self._bytes > _MOST_BYTES and len(self._with_payload) > 1:
            forgotten, size = self._with_payload.popitem(last=False)
            self._replies[forgotten].payload = None
            self._bytes -= size
        while len(self._replies) > _MOST_REQUESTS:
            oldest, _ = self._replies.popitem(last=False)
            self._bytes -= self._with_payload.pop(oldest, 0)

    def to_send(self, key: Key, now: float) -> bytes | None:
        """Return the reply to send at ``now`` [s]; None while it is under way, or if forgotten."""
        reply = self._replies[key]
        if reply.payload is None or now < reply.arrives:
            return None
        reply.arrives = now + len(reply.payload) / BYTES_A_SECOND
        return reply.payload
