"""Detecting messages of a sender that waited on their way, by clocks that need not agree.

Pure. The fastest message so far did not wait; a message that takes a second longer has waited for
the network. Two clocks drift apart by less than a thousandth. If all messages are late for ten
seconds, none has waited: a clock was set, as after a computer's sleep.
"""

LATE = 1_000_000_000  # [ns]
_JUMP = 10 * LATE
_DRIFT = 1000  # ns in which clocks drift apart by 1 ns at most


class Lateness:
    """The lateness of one sender's messages."""

    def __init__(self) -> None:
        self._fastest: int | None = None  # smallest arrival time minus sending time so far [ns]
        self._last = 0  # last arrival, by the receiver's clock [ns]
        self._late: tuple[int, int] | None = None  # since when all are late, and their fastest

    def is_late(self, sent: int, arrival: int) -> bool:
        """Return whether a message has waited too long.

        ``sent`` is by the sender's clock, ``arrival`` by the receiver's [ns].
        """
        took = arrival - sent
        if self._fastest is None:
            self._fastest = took
        else:
            self._fastest = min(self._fastest + (arrival - self._last) // _DRIFT, took)
        self._last = arrival
        if took - self._fastest <= LATE:
            self._late = None
            return False
        since, fastest = self._late or (arrival, took)
        self._late = since, min(fastest, took)
        if arrival - since > _JUMP:
            self._fastest, self._late = min(fastest, took), None
            return False
        return True
