"""The schedule of announcements: each period, on a change, and on a probe.

Pure: times [s] come in as arguments, of a monotonic clock. The thread of a node's program, or the
reading loop of a command, announces what ``take`` returns, and tells ``rest`` what that has cost.
"""

import math
import random
from collections.abc import Mapping

from lcmtools.graph.protocol import PERIOD, Probe

_CHANGE_DELAY = 0.005  # [s]: a node that is being set up changes many times at once
_REST = 10  # rest for this many times the CPU time of announcing, which takes a tenth at most


class Announcing:
    """The announcements that the nodes of one program owe.

    ``spread`` is the time over which answers to a probe of all nodes are spread [s].
    """

    def __init__(self, now: float, spread: float = 0.0) -> None:
        self._spread = spread
        self._next, self._rested = now + _CHANGE_DELAY, 0.0  # of what nobody asks for
        self._answers: dict[str, tuple[float, int]] = {}
        """When, and with which nonce, probes are to be answered, by target: "" for all nodes."""
        self._answers_from = 0.0  # not before
        self._is_asked_again = self._is_answering = False
        self._worked = 0.0

    def change(self, now: float) -> None:
        """Announce all nodes in a moment, because one has changed."""
        self._next = min(self._next, now + _CHANGE_DELAY)

    def ask(self, probe: Probe, now: float) -> None:
        """Answer a probe: several at a time get one answer, with the last one's nonce."""
        spread = 0.0 if probe.target else random.uniform(0, self._spread)  # noqa: S311
        due, nonce = self._answers.get(probe.target, (math.inf, 0))
        # a second probe is sent in case an answer is lost: it gets an answer of its own
        self._is_asked_again |= not probe.target and due < math.inf
        self._answers[probe.target] = min(due, now + spread), probe.nonce or nonce

    def due(self) -> float:
        """Return the time of the next announcement."""
        answer = min((due for due, _ in self._answers.values()), default=math.inf)
        return min(max(answer, self._answers_from), max(self._next, self._rested))

    def take(self, now: float) -> Mapping[str, int]:
        """Return the nonces to announce nodes with now, by name, "" for all; empty for nothing."""
        answers = self._answers.items() if now >= self._answers_from else ()
        owed = {name: nonce for name, (due, nonce) in answers if due <= now}
        self._is_answering = bool(owed)
        for name in owed:
            del self._answers[name]
        if now >= max(self._next, self._rested):
            owed.setdefault("", 0)
        if "" in owed:
            self._next = now + PERIOD
            if self._is_asked_again:
                self._answers[""] = now + self._spread, 0
            self._is_asked_again = False
        return owed

    def rest(self, now: float, worked: float) -> None:
        """Rest after announcing what was taken last, which took so much CPU time [s]."""
        rest = min(PERIOD, _REST * min(worked, self._worked))  # the first one imports modules
        self._worked = worked
        if self._is_answering:
            self._answers_from = now + max(rest, self._spread)
        else:
            self._rested = now + rest
