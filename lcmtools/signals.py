"""Signals that request a process to end, and when two of them are one request."""

import signal
import time

ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)

_DOUBLED = 0.05  # [s] in which a second signal is the same request


class Doubles:
    """Tells the second of two signals that come together: timeout(1) sends its own twice."""

    def __init__(self) -> None:
        self._until = 0.0

    def is_double(self) -> bool:
        """Return whether the signal that has come now is the same request as the one before."""
        now = time.monotonic()
        if now < self._until:
            return True
        self._until = now + _DOUBLED
        return False
