"""The times at which a lost connection is tried again.

Belongs here: plain time. Must know neither sockets nor threads.
"""

_FIRST_PAUSE = 0.2  # [s]
_LONGEST_PAUSE = 2.0  # [s]


class ReconnectBackoff:
    """The time while there is no connection; each attempt waits twice as long as the one before."""

    def __init__(self) -> None:
        self._pause = _FIRST_PAUSE
        self._due: float | None = None

    @property
    def is_on(self) -> bool:
        """True if the connection is lost."""
        return self._due is not None

    def begin(self, now: float) -> None:
        """The connection is lost, at this time [s]."""
        self._pause = _FIRST_PAUSE
        self._due = now + self._pause

    def put_off(self, now: float) -> None:
        """An attempt has failed, at this time [s]."""
        self._pause = min(2 * self._pause, _LONGEST_PAUSE)
        self._due = now + self._pause

    def end(self) -> None:
        """The connection is back."""
        self._due = None

    def left(self, now: float) -> float | None:
        """The time until the next attempt [s], 0 where it is due; None where there is no outage."""
        return None if self._due is None else max(0.0, self._due - now)
