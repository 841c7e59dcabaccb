"""Which messages are too late, by the clocks of their senders; a clock that was set is noticed.

If all messages of a sender are late, all sessions are asked for the time.
"""

import time
from collections import deque

from lcmtools.bounded import BoundedDict
from lcmtools.bus.zenoh.keep_last_sender import CLOCK
from lcmtools.bus.zenoh.opening import zenoh
from lcmtools.wire.lateness import Lateness
from lcmtools.wire.stamp import Stamp, decode_stamp, encode_stamp

_PERIOD = 2_000_000_000  # [ns] between comparisons of clocks, at least
_TIMEOUT = 1.0  # [s]


class LateMessages:
    """The lateness of all senders' messages; ``key`` is that of the question for the time."""

    def __init__(self, session: zenoh.Session, key: str) -> None:
        self._session, self._key = session, key
        self._lateness = BoundedDict[int, Lateness]()  # by sender
        self._answers: deque[tuple[int, int, int, int]] = deque()  # from Zenoh's threads
        self._next = 0  # [ns]

    def is_late(self, stamp: Stamp, arrival: int) -> bool:
        """Return whether a message was held up on its way; ``arrival`` is by ``CLOCK`` [ns]."""
        if not stamp.time:
            return False
        while self._answers:
            sender, *times = self._answers.popleft()
            if sender in self._lateness:
                self._lateness[sender].compare(*times)
        lateness = self._lateness.use(stamp.sender)
        if lateness is None:
            lateness = self._lateness[stamp.sender] = Lateness()
        is_late = lateness.is_late(stamp.time, arrival)
        if lateness.is_doubtful and arrival >= self._next:
            self._compare(time.clock_gettime_ns(CLOCK))
        return is_late

    def _compare(self, now: int) -> None:
        self._next = now + _PERIOD

        def note(reply: zenoh.Reply) -> None:
            arrival = time.clock_gettime_ns(CLOCK)
            attachment = reply.ok.attachment if reply.ok else None
            stamp = decode_stamp(attachment.to_bytes()) if attachment else None
            if stamp:
                self._answers.append((stamp.sender, stamp.time, arrival, arrival - now))

        self._session.get(
            self._key,
            zenoh.handlers.Callback(note, indirect=False),
            target=zenoh.QueryTarget.ALL,
            consolidation=zenoh.ConsolidationMode.NONE,
            priority=zenoh.Priority.INTERACTIVE_HIGH,
            timeout=_TIMEOUT,
        )


def tell_time(query: zenoh.Query, sender: int) -> None:
    """Reply with the time, to a session that compares its clock, or only waits for a reply."""
    query.reply(
        query.key_expr, b"", attachment=encode_stamp(sender, 0, time.clock_gettime_ns(CLOCK))
    )
