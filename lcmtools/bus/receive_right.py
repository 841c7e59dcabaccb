"""The right to receive from a bus, which one thread has at a time: a leader or the bus's own.

A thread that waits for messages leads: messages are handled where their callbacks run, without a
switch of threads. It keeps the right from one wait to the next, and only notes when it is away, for
example in a callback. If it stays away, the bus's own thread takes the right until it is back.

Neither waits for a lock while nothing changes hands: each first says what it is about to do, and
then looks at what the other says, so that at least one of them sees the other. The bus's own thread
never receives while the leader does, also where several threads wait.
"""

import contextlib
import threading
import time
from collections.abc import Callable

from lcmtools.bus.wakeup import WakeupEvent

_PATIENCE = 0.015  # [s] that a leader may be away; up to twice as long happens
_MOST_PATIENT = 8  # times as long
_LONGEST_TURN = 1.0  # [s] that closing waits for a receiving thread
_LOOK_AGAIN = 0.001  # [s]
_HERE, _AWAY, _OUTSIDE = 1, 2, 3  # before ``come``: receiving, in a callback, in no wait


class ReceiveRight:
    """The right to receive from a bus.

    Attributes:
        is_lendable: True if other threads may lead.
        lead: Held by the leader; nothing waits for it.
        receiving: Held by the bus's own thread while it receives, after ``follow``.
        leader: The thread that leads: a wait of it has begun and not ended. 0 for none.
        latest: The thread that was the last to lead; 0 for none.
        is_away: No leader receives now; written by the leader only.
        is_taken: The bus's own thread receives, or is about to.
        turns: Times that a leader went away.
        is_pressing: False if more than a moment's messages fit into the buffer.
        own: The bus's own thread.
        wakeup: Wakes the thread that receives, or the next one.
        is_closed: Set at the end, before ``wake``.
    """

    def __init__(self, *, is_lendable: bool) -> None:
        self.is_lendable = is_lendable
        self.leader = self.latest = self.own = self.turns = 0
        self.is_away = self.is_taken = True
        self.is_closed = False
        self.is_pressing, self._patience = True, 1
        self.wakeup = WakeupEvent()
        self.lead = threading.Lock()
        self.receiving = threading.Lock()
        # What that thread sleeps on. A thread that gets a lock needs no call to clear it: after
        # each, it would wait for the interpreter while a callback runs.
        self._alarm = threading.Lock()
        self._alarm.acquire()
        self._seen = 0  # turns that the bus's own thread knows
        self.is_own_asleep = False  # it sleeps until the leader goes away

    @property
    def is_own_turn(self) -> bool:
        """True while the bus's own thread may receive; it looks before each turn."""
        return self.is_taken and self.is_away

    def come(self) -> int:
        """Let the calling thread receive; return what ``leave`` needs, 0 if it has no right to.

        If several threads wait, the bus's own must serve all from now on. One that leads already
        comes back from a callback, or waits within it; this must not be refused.
        """
        thread = threading.get_ident()
        if self.leader == thread:
            before = _AWAY if self.is_away else _HERE
        elif self.lead.acquire(blocking=False):
            self.leader = self.latest = thread
            before = _OUTSIDE
        else:
            self.is_lendable = False
            self.wake()
            return 0
        self.is_away = False
        if self.is_taken:
            self._take_back(before)
        if before == _OUTSIDE and not self.is_lendable:  # meanwhile
            self.leave(before)
            return 0
        return before

    def leave(self, before: int) -> None:
        """Undo ``come``; the leader is trusted to come back soon."""
        if before == _HERE:
            return
        self.is_away = True
        self.turns += 1
        if before == _OUTSIDE:
            self.leader = 0
            self.lead.release()
        if self.is_own_asleep:
            self.wake_own()

    def hand_over(self) -> None:
        """Stop trusting that a leader that is away comes back soon."""
        if self.is_away:
            self._seen = self.turns
            self.wake_own()

    def follow(self, has_work: Callable[[], bool]) -> None:
        """Wait on the bus's own thread until it must receive.

        That is if no other leads, or stays away, or there is work, such as a request that came just
        as it went away.
        """
        while not self.is_closed and not (self.is_away and has_work()):
            if not self.is_away and (not self.is_lendable or self.turns == self._seen):
                self.is_own_asleep = True
                if not self.is_away:
                    self._alarm.acquire()
                self.is_own_asleep = False
            elif self.is_away and (not self.is_lendable or self.turns == self._seen):
                break
            else:  # the leader comes and goes: its next turn need not wake this thread
                turns = self.turns
                # else an earlier turn woke it
                if not self._alarm.acquire(timeout=self._patience * _PATIENCE):
                    self._seen = turns
                    # a leader that is often in long callbacks is soon found in one
                    is_impatient = self.is_away or self.is_pressing
                    self._patience = 1 if is_impatient else min(2 * self._patience, _MOST_PATIENT)
        self.is_taken = True

    def wake(self) -> None:
        """Wake the thread that receives and the bus's own."""
        self.wakeup.set()
        self.wake_own()

    def wake_own(self) -> None:
        """Wake the bus's own thread."""
        with contextlib.suppress(RuntimeError):  # it is awake
            self._alarm.release()

    def close(self) -> None:
        """Free the descriptors, once no thread waits."""
        # a signal handler may close the bus on the thread that receives
        deadline = time.monotonic() + _LONGEST_TURN
        while not self.is_away and self.leader != threading.get_ident():
            if time.monotonic() > deadline:
                break
            time.sleep(_LOOK_AGAIN)
        self.wakeup.close()

    def _take_back(self, before: int) -> None:
        self.wakeup.set()
        try:
            with self.receiving:
                self.is_taken = False
        except BaseException:  # for example Ctrl-C
            self.leave(before)
            raise
