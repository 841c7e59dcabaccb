"""The replies that a service has sent: a repeated request gets its reply again, unexecuted.

Must not know messages or the bus.
"""

from collections import OrderedDict
from dataclasses import dataclass

BYTES_A_SECOND = 20e6
"""The least rate at which large replies travel: none is sent again before it can have arrived."""
_MOST_REQUESTS = 10_000
"""The number of answered requests remembered; an older one, if repeated, is executed again."""
_MOST_BYTES = 64 << 20
"""Bytes of replies that are kept to be repeated; beyond this, the oldest are forgotten."""
Key = tuple[str, int]
"""A client and its request's sequence number."""


@dataclass(slots=True)
class _Reply:
    payload: bytes | None  # None once forgotten
    arrives: float  # [s]; if its request is repeated after this time, it was lost


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
        """Return the reply to send at ``now`` [s]; None if it is still under way or forgotten."""
        reply = self._replies[key]
        if reply.payload is None or now < reply.arrives:
            return None
        reply.arrives = now + len(reply.payload) / BYTES_A_SECOND
        return reply.payload
