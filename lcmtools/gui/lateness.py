"""The lateness of a page's requests, which waited for a suspended server or in a broken network.

Pure: times are arguments [s]. The clocks of page and server differ by an unknown constant; the
least difference seen so far counts as no delay.
"""

from lcmtools.gui.dead_man import HOLD

LATEST_DRIVE = HOLD  # [s] after which a command to drive is obsolete
LATEST_ACTION = 2.0  # [s] the same for a click
_DRIFT = 1e-4  # between two clocks, as a fraction
_LONGEST_GAP = 0.2  # [s] that counts between two requests: what has waited comes all at once
_ENOUGH = 3.0  # [s] of lateness at a steady rate after which a clock was set, or stood still


class Lateness:
    """The lateness of one page's requests."""

    def __init__(self) -> None:
        self._least: float | None = None
        self._sent = self._came = self._late_time = 0.0

    def of(self, sent: float, now: float) -> float:
        """Return how late a request is that comes now [s]."""
        difference = now - sent
        if self._least is None:
            self._least, self._sent, self._came = difference, sent, now
        self._least += max(0.0, sent - self._sent) * _DRIFT
        late = difference - self._least
        is_late = late > LATEST_DRIVE
        gap = min(now - self._came, _LONGEST_GAP)
        self._late_time = self._late_time + gap if is_late else 0.0
        self._sent, self._came = sent, now
        if late < 0 or self._late_time > _ENOUGH:
            self._least, late = difference, 0.0
        return late
