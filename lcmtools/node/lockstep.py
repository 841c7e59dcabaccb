"""Lock-step with a program that plays a recording (``bag rerun``): steps, and answers to them.

A step follows a message, or a time of ``/clock``, on the same connection. It is answered when all
callbacks have ended and all timers that are due have run, and so after everything that they
published. docs/protocol.md describes it, for nodes in any language.
"""

import struct
from collections.abc import Callable, Collection, Mapping, Sequence

from lcmtools.bus.base import LOCKSTEP, Bus
from lcmtools.bus.step_bus import DONE_CHANNEL, STEP_CHANNEL
from lcmtools.node.callbacks import Callbacks
from lcmtools.node.timer import NEVER

STEP, DONE = struct.Struct(">q"), struct.Struct(">qq")
"""The number of a step; the same number, and the time of the next timer [ns], NEVER for none."""


class Lockstep:
    """The answers of a process; ``all_callbacks`` returns those of all its nodes.

    ``wake`` wakes the threads that spin.
    """

    def __init__(
        self,
        bus: Bus,
        start: int,
        all_callbacks: Callable[[], Collection[Callbacks]],
        wake: Callable[[], None],
    ) -> None:
        self.start = start  # the time at the start [ns]
        self._bus, self._all, self._wake = bus, all_callbacks, wake
        self._number: int | None = None
        self._idle: set[Callbacks] = set()
        bus.subscribe(STEP_CHANNEL, self._receive)

    def answer(self, idle: Sequence[Callbacks]) -> None:
        """Answer the step, if any, for a thread that has nothing left to do for its callbacks.

        The last one of several threads that spin answers.
        """
        number, known = self._number, self._all()  # the step first: messages came before it
        if number is None:
            return
        self._idle.update(one for one in idle if not one.ready)
        if any(one.ready for one in known):
            return
        if self._idle.issuperset(one for one in known if one.spinning_thread is not None):
            self._number = None
            due = min((one.next_due() for one in known), default=NEVER)
            self._bus.publish(DONE_CHANNEL, DONE.pack(number, due))

    def _receive(self, payload: bytes, _time: int) -> None:
        self._idle = set()
        (self._number,) = STEP.unpack(payload)
        if len({one.spinning_thread for one in self._all()}) > 1:
            self._wake()  # also those that got no message


def join_lockstep(
    bus: Bus,
    environment: Mapping[str, str],
    all_callbacks: Callable[[], Collection[Callbacks]],
    wake: Callable[[], None],
) -> Lockstep | None:
    """Return the answers of a process that a recording is played to; None if it runs as usual."""
    text = environment.get(LOCKSTEP, "")
    is_played_to = text.isascii() and text.isdigit()
    return Lockstep(bus, int(text), all_callbacks, wake) if is_played_to else None
