"""Counting losses by the senders' sequence numbers.

Sans-I/O. Each LCM instance numbers its messages, so a gap is a lost message. A late message closes
its gap again; numbers that restart are another run of the program. An incomplete message counts as
lost once a later one of several parts has begun, or many others have come: while a sender paces a
large message, it sends small ones with later numbers.
"""

_MODULUS = 1 << 32
_MOST_LATE = 1000
"""A number at most this far behind the newest is late; one further behind is a restart."""
_MOST_RESTARTS = 1
"""Restarts expected of one program on a port; if several share it, there are many more."""
_MOST_BETWEEN = 100
"""Messages that come at most between the parts of a large one that is still on its way."""
_MOST_LOST = 1 << 20
"""A jump over more messages than this is a restart, not a loss."""


class Sequence:
    """The sequence numbers of one sender's messages, in order of arrival."""

    __slots__ = ("_begun", "_lost", "_missing", "_newest", "messages", "restarts")

    def __init__(self) -> None:
        self.messages = 0
        """The number of messages that arrived."""
        self.restarts = 0
        """The number of restarts; many if several programs share the port."""
        self._lost = 0
        self._newest = self._begun = -1
        self._missing: set[int] = set()

    @property
    def is_shared(self) -> bool:
        """True if several programs send from the port, so that their numbers are mixed."""
        return self.restarts > _MOST_RESTARTS

    @property
    def sent(self) -> int:
        """The number of messages that the sender has sent, by the newest number; 0 before any."""
        return self._newest + 1

    @property
    def lost(self) -> int:
        """The number of messages between the first and the newest that did not arrive."""
        is_coming = self._begun in self._missing and self._newest - self._begun <= _MOST_BETWEEN
        return self._lost - is_coming  # more parts of that one may come

    def begin(self, seqno: int) -> None:
        """Take the number of a message whose first parts have arrived."""
        step = (seqno - self._newest) % _MODULUS if self._newest >= 0 else 1
        if 0 < step <= _MOST_LOST:
            if step > 1:
                self._leap(seqno, step)
            self._newest = self._begun = seqno
            self._lost += 1
            self._missing.add(seqno)

    def add(self, seqno: int) -> None:
        """Take the number of a message that has arrived."""
        self.messages += 1
        if seqno == self._newest + 1:  # the usual case
            self._newest = seqno
            return
        step = (seqno - self._newest) % _MODULUS
        if step == 1 or self._newest < 0:
            self._newest = seqno
        elif 0 < step <= _MOST_LOST:
            self._leap(seqno, step)
        else:
            self._return(seqno, _MODULUS - step if step else 0)

    def _leap(self, seqno: int, step: int) -> None:
        self._lost += step - 1
        recent = range(max(1, step - _MOST_LATE), step)
        self._missing.update((self._newest + ahead) % _MODULUS for ahead in recent)
        self._newest = seqno
        if len(self._missing) > 2 * _MOST_LATE:
            self._missing = {one for one in self._missing if (seqno - one) % _MODULUS <= _MOST_LATE}

    def _return(self, seqno: int, behind: int) -> None:
        if seqno in self._missing:
            self._missing.discard(seqno)
            self._lost -= 1
        elif behind > _MOST_LATE or (seqno == 0 and behind > 1):
            self.restarts += 1
            self._newest = seqno
            self._missing.clear()
