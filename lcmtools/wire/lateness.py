"""Detecting messages of a sender that waited on their way, by clocks that need not agree.

Pure. The fastest message so far did not wait; a message that takes a second longer has waited for
the network. Two clocks drift apart by less than a thousandth. If all messages are late for some
seconds, either they still wait, or a clock was set, as when a virtual machine was paused: a
question to the sender tells, because its clock's time of the answer lies within the round trip.
"""

LATE = 1_000_000_000  # [ns]
_DOUBT = 2 * LATE
_LONGEST_ROUND_TRIP = LATE // 2
_DRIFT = 1000  # ns in which clocks drift apart by 1 ns at most


class Lateness:
    """The lateness of one sender's messages."""

    def __init__(self) -> None:
        self._fastest: int | None = None  # smallest arrival time minus sending time so far [ns]
        self._last = 0  # last arrival, by the receiver's clock [ns]
        self._late_since: int | None = None  # first arrival of those that are all late

    @property
    def is_doubtful(self) -> bool:
        """True if all messages have been late for so long that the clocks must be compared."""
        return self._late_since is not None and self._last - self._late_since > _DOUBT

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
            self._late_since = None
            return False
        if self._late_since is None:
            self._late_since = arrival
        return True

    def compare(self, answered: int, arrival: int, round_trip: int) -> None:
        """Compare the clocks by an answer of the sender, and forget what was fastest before.

        ``answered`` is by the sender's clock, the others by the receiver's [ns]. An answer that had
        to wait tells nothing.
        """
        if round_trip <= _LONGEST_ROUND_TRIP:
            self._fastest, self._last = arrival - answered - round_trip // 2, arrival
            self._late_since = None
