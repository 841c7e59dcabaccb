"""Which messages of a sender have waited on their way, by clocks that need not agree.

Pure. The fastest message so far took no longer than the line does; what takes a second longer than
that has waited for it. Two clocks drift apart by less than a thousandth. If all messages are late
for ten seconds, then none has waited: a clock was set, as by a computer that slept.
"""

LATE = 1_000_000_000  # [ns]
_JUMP = 10 * LATE
_DRIFT = 1000  # ns in which clocks drift apart by one


class Lateness:
    """The lateness of one sender's messages."""

    def __init__(self) -> None:
        self._fastest: int | None = None  # [ns] between two clocks
        self._last = 0  # [ns] by the receiver's clock
        self._late: tuple[int, int] | None = None  # since when all are, and the fastest of them

    def is_late(self, sent: int, arrival: int) -> bool:
        """Return whether a message has waited for too long.

        The time of sending is by the sender's clock, that of arrival by the receiver's [ns].
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
