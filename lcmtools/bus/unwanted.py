"""Large messages that a program receives without wanting them, to be dropped in the kernel.

Only the first fragment of a message names its channel, so all others pass the kernel's filter, and
images for other programs would cost more than a node's own messages. If many fragments come whose
first one was dropped, the filter drops those of the same port and size. Must not know sockets.
"""

from lcmtools.bounded import BoundedDict

_MOST = 40  # fragments of one port and size within a period; further ones are to be dropped
_PERIOD = 200_000_000  # [ns]
_MOST_DENIED, _MOST_COUNTED = 16, 1000


class UnwantedMessages:
    """The large messages to be dropped.

    Attributes:
        denied: Their source ports and sizes.
    """

    def __init__(self) -> None:
        self.denied: list[tuple[int, int]] = []
        # when counting began [ns], and the number of fragments
        self._counts: BoundedDict[tuple[int, int], tuple[int, int]] = BoundedDict(_MOST_COUNTED)
        self._wanted: BoundedDict[int, None] = BoundedDict(_MOST_COUNTED)  # ports; as a set

    def note(self, port: int, size: int, now: int) -> bool:
        """Count a fragment without a first one [ns]; return whether ``denied`` has changed."""
        if port in self._wanted or (port, size) in self.denied:
            return False
        began, count = self._counts.pop((port, size), (now, 0))
        if not 0 <= now - began <= _PERIOD:
            began, count = now, 0
        if count >= _MOST:
            self.denied = [*self.denied[1 - _MOST_DENIED :], (port, size)]
            return True
        self._counts[port, size] = began, count + 1
        return False

    def want(self, port: int) -> bool:
        """Never drop messages from this port; return whether ``denied`` has changed."""
        self._wanted[port] = None
        before, self.denied = self.denied, [one for one in self.denied if one[0] != port]
        return before != self.denied

    def clear(self) -> bool:
        """Forget what was unwanted, because other channels are wanted now; return as ``want``."""
        self._counts.clear()
        before, self.denied = self.denied, []
        return bool(before)
