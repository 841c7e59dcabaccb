"""The right to receive from a bus, which one thread has at a time: leader and follower.

A bus has its own thread, and lends the right to a thread that waits for messages: messages are then
handled where their callbacks run, without a switch of threads. While that thread is away, for
example in a callback, the bus's own thread waits for a moment and then receives again.
"""

import contextlib
import threading
from collections.abc import Callable

from lcmtools.bus.wakeup import WakeupEvent

_PATIENCE = 0.015  # [s] that a thread that has received may be away; up to twice as long happens
_LONGEST_TURN = 1.0  # [s] that closing waits for a receiving thread


class ReceiveRight:
    """The right to receive from a bus; a context manager for the bus's own thread."""

    def __init__(self, *, is_lendable: bool) -> None:
        self.is_lendable = is_lendable  # True if other threads may receive
        self.thread = 0  # the thread that receives now; 0 for none
        self.wakeup = WakeupEvent()  # wakes that thread, or the next one
        # What the bus's own thread sleeps on. A thread that gets a lock needs no call to clear it:
        # after each, it would wait for the interpreter while a callback runs.
        self._alarm = threading.Lock()
        self._alarm.acquire()
        self._lock = threading.Lock()  # held by the thread that receives
        self.is_leader_here = False  # True while another thread receives or is about to
        self._is_asleep = False  # True if the bus's own thread sleeps until the leader leaves
        self.turns = self._seen = 0  # turns of leaders; those that the bus's own thread knows

    def __enter__(self) -> None:
        """Receive on the bus's own thread."""
        self._lock.acquire()
        self.thread = threading.get_ident()

    def __exit__(self, *_: object) -> None:
        """Stop receiving."""
        self.thread = 0
        self._lock.release()

    def lead(self) -> bool:
        """Take the right for the calling thread, until ``leave``; return False if there is none."""
        if self.is_leader_here:
            self.is_lendable = False  # several threads wait: the bus's own must serve all
            self.wake()
            return False
        self.is_leader_here = True
        if not self._lock.acquire(blocking=False):
            self.wakeup.set()
            try:
                self._lock.acquire()
            except BaseException:  # for example Ctrl-C
                self.is_leader_here = False
                raise
            self.is_leader_here = True  # set again: another leader may have left meanwhile
        self.thread = threading.get_ident()
        return True

    def leave(self) -> None:
        """Return the right; the thread is trusted to come back soon."""
        self.thread = 0
        self.turns += 1
        self.is_leader_here = False
        self._lock.release()
        if self._is_asleep:
            self._wake_own()

    def hand_over(self) -> None:
        """Stop trusting that a thread that is away comes back soon."""
        if not self.is_leader_here:
            self._seen = self.turns
            self._wake_own()

    def follow(self, has_work: Callable[[], bool]) -> bool:
        """Wait on the bus's own thread while another receives or will soon do so again.

        Returns False if the bus's own thread must receive: no other does, or there is work for it,
        such as a request that came just as the other one left.
        """
        if self._is_leader_trusted() and not has_work():  # its next turn need not wake this thread
            self._seen = self.turns
            self._alarm.acquire(timeout=_PATIENCE)
        elif self.is_leader_here:
            self._is_asleep = True
            if self.is_leader_here:
                self._alarm.acquire()
            self._is_asleep = False
        return self.is_leader_here or (self._is_leader_trusted() and not has_work())

    def wake(self) -> None:
        """Wake the receiving thread and the bus's own thread."""
        self.wakeup.set()
        self._wake_own()

    def close(self) -> None:
        """Free the descriptors, once no thread waits."""
        # a signal handler may close the bus on the receiving thread itself
        is_here = self.thread == threading.get_ident()
        is_taken = not is_here and self._lock.acquire(timeout=_LONGEST_TURN)
        self.wakeup.close()
        if is_taken:
            self._lock.release()

    def _wake_own(self) -> None:
        with contextlib.suppress(RuntimeError):  # it is awake
            self._alarm.release()

    def _is_leader_trusted(self) -> bool:
        """Return whether a leader has come and gone since the bus's own thread last looked."""
        return self.is_lendable and self.turns != self._seen
