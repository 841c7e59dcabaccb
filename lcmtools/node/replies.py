"""The replies that a service has sent: a repeated request gets its reply again, unexecuted.

Must not know messages or the bus.
"""

from lcmtools.bounded import BoundedDict

BYTES_A_SECOND = 20e6
"""The least rate at which large replies travel: none is sent again before it can have arrived."""
_MOST_BYTES = 64 << 20
"""Bytes of replies that are kept to be repeated; beyond this, the oldest are forgotten."""
Key = tuple[str, int]
"""A client and its request's sequence number."""


class Replies:
    """The latest replies of one service; a request that is forgotten would be executed again."""

    def __init__(self) -> None:
        self._arrive = BoundedDict[Key, float]()  # [s]; a request repeated later got no reply
        self._payloads = BoundedDict[Key, bytes](most_bytes=_MOST_BYTES)

    def __contains__(self, key: Key) -> bool:
        """Return whether a request has been answered."""
        return key in self._arrive

    def add(self, key: Key, payload: bytes) -> None:
        """Remember a reply."""
        self._arrive[key] = 0.0
        self._payloads.put(key, payload, len(payload))

    def to_send(self, key: Key, now: float) -> bytes | None:
        """Return the reply to send at ``now`` [s]; None if it is still under way or forgotten."""
        payload = self._payloads.get(key)
        if payload is not None and now >= self._arrive[key]:
            self._arrive[key] = now + len(payload) / BYTES_A_SECOND
            return payload
        return None
