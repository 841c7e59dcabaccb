"""Detecting echoes from a server that sends everything back without the sender. Pure.

Sent messages come back in the order of sending, unless the server drops them. A message equal to a
sent one is taken for its echo: if it is in fact another program's, then the echo itself passes in
its place, and nobody can tell the difference.
"""

import threading
from collections import deque

_MOST_BEHIND = 1000  # an echo this far behind the latest one counts as lost
_Key = tuple[str, int, int]


class EchoFilter:
    """The messages whose echoes are expected."""

    def __init__(self) -> None:
        self._lock = threading.Lock()  # one thread sends, another receives
        self._order: deque[tuple[int, _Key]] = deque()
        self._numbers: dict[_Key, deque[int]] = {}
        self._sent = 0

    def sends(self, channel: str, payload: bytes) -> None:
        """Note a message that is about to be sent."""
        key = _key(channel, payload)
        with self._lock:
            self._sent += 1
            self._numbers.setdefault(key, deque()).append(self._sent)
            self._order.append((self._sent, key))

    def is_echo(self, channel: str, payload: bytes) -> bool:
        """Return whether a received message is an echo; if so, it is no longer expected."""
        key = _key(channel, payload)
        with self._lock:
            numbers = self._numbers.get(key)
            if not numbers:
                return False
            number = numbers.popleft()
            if not numbers:
                del self._numbers[key]
            while self._order and self._order[0][0] < number - _MOST_BEHIND:
                self._forget(*self._order.popleft())
            return True

    def clear(self) -> None:
        """Expect no echoes, because the connection is new."""
        with self._lock:
            self._numbers.clear()
            self._order.clear()

    def _forget(self, number: int, key: _Key) -> None:
        numbers = self._numbers.get(key)
        if numbers and numbers[0] == number:
            numbers.popleft()
            if not numbers:
                del self._numbers[key]


def _key(channel: str, payload: bytes) -> _Key:
    return channel, len(payload), hash(payload)
