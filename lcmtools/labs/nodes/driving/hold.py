"""True if a key is still held down, as far as a terminal tells. Pure: time is an argument.

A terminal says only that a key came. A key that is held comes again: the second time after a
quarter to two thirds of a second, as the system is set, and then many times a second.
"""

FIRST_TIME = 0.7
"""Seconds that a key counts as held when it comes for the first time."""
NEXT_TIME = 0.2
"""Seconds that it counts as held when it has come again."""


class Hold:
    """Follows one key that is held down."""

    def __init__(self) -> None:
        self._key = ""
        self._until = 0

    def press(self, key: str, now: int) -> None:
        """A key has come at ``now`` [ns]."""
        is_repeated = key == self._key and now < self._until
        self._until = now + round((NEXT_TIME if is_repeated else FIRST_TIME) * 1e9)
        self._key = key

    def is_over(self, now: int) -> bool:
        """Return whether it must have been let go before ``now`` [ns]."""
        return now >= self._until
