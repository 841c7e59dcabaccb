"""A rate for a program's own loop: ``while lcmtools.ok(): ...; rate.sleep()``."""

import threading
import time

from lcmtools.bus.base import refusal
from lcmtools.errors import UsageError
from lcmtools.node.callbacks import Callbacks
from lcmtools.node.context import Context
from lcmtools.node.timer import Timer

_POLL_PERIOD = 0.001  # [s] , if another thread runs the callbacks and sets simulated time


class Rate:
    """Keeps a loop at the rate of a timer, on the node's clock. Made by ``Node.create_rate``."""

    def __init__(self, context: Context, callbacks: Callbacks, timer: Timer) -> None:
        self._context = context
        self._callbacks = callbacks
        self._timer = timer

    def sleep(self) -> None:
        """Wait until the next period begins, and run the node's callbacks meanwhile.

        Returns at once if it has already begun, and early when the program should end. If ``spin``
        runs the callbacks on another thread, this one only waits.

        Raises:
            UsageError: A callback calls it: no other, not even that of ``/clock``, could run.
            BusOfParent: This is a forked process, and the node is its parent's.
        """
        context, callbacks = self._context, self._callbacks
        if context.is_of_parent:
            raise refusal(is_of_parent=True)
        if callbacks.spinning_thread == threading.get_ident():
            hint = "let create_timer call it periodically, or loop without spin"
            raise UsageError("rate.sleep() in a callback keeps all others waiting", hint)
        callbacks.awaited = self._timer
        while context.ok() and not self._timer.is_due(callbacks.time()):
            if callbacks.spinning_thread is None:
                context.run_once((callbacks,), callbacks.time_to_timer(self._timer))
            else:
                time.sleep(_POLL_PERIOD)
        callbacks.awaited = None
        self._timer.advance(callbacks.time())
