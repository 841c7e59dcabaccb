"""Signals that ask a process to end, and the detection of duplicates."""

import signal
import time

ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)

_DOUBLED = 0.05  # [s] within which a second signal is the same request


def ending_signals() -> list[signal.Signals]:
    """Return the signals that end this process now; under nohup, SIGHUP is not one."""
    hangs_up = signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN
    return [number for number in ENDING if number != signal.SIGHUP or hangs_up]


class Doubles:
    """Detects duplicate signals: timeout(1) sends each one twice."""

    def __init__(self) -> None:
        self._until = 0.0

    def is_double(self) -> bool:
        """Return True if the signal received now repeats the previous request."""
        now = time.monotonic()
        if now < self._until:
            return True
        self._until = now + _DOUBLED
        return False
