"""The callbacks that the spinning thread runs: of subscriptions, services and timers.

Exceptions of user code are caught here and passed to ``CallbackErrors``. A node's name and its
announcements are not known here.
"""

import time
from collections.abc import Callable
from functools import partial
from typing import TypeVar

from lcmtools.clock import Clock, ManualClock, SystemClock
from lcmtools.errors import DecodeError, LcmtoolsError
from lcmtools.messages.registry import Message
from lcmtools.node.callback_errors import CallbackErrors
from lcmtools.node.logger import Logger
from lcmtools.node.parameters import PARAMETERS_SUFFIX
from lcmtools.node.service import Service
from lcmtools.node.stopwatch import Stopwatch
from lcmtools.node.subscription import Subscription, Waiting
from lcmtools.node.timer import NEVER, Timer

SourceT = TypeVar("SourceT")


class Callbacks(Waiting):
    """The callbacks of one node, run while ``go_on`` returns True; ``errors`` takes exceptions."""

    def __init__(self, logger: Logger, errors: CallbackErrors, go_on: Callable[[], bool]) -> None:
        super().__init__()
        self.subscriptions: list[Subscription] = []
        self.services: list[Service[Message, Message]] = []
        self.timers: list[Timer] = []
        self.clock: Clock = SystemClock()
        """The node's clock; timers use it only if it gives simulated time."""
        self.spinning_thread: int | None = None
        """The thread on which ``spin`` is running them; None if there is none."""
        self.awaited: Timer | None = None
        """The timer of a rate that a loop waits for."""
        self._timed = Stopwatch()
        self._logger = logger
        self._errors = errors
        self._go_on = go_on
        self._cleared = False

    def on_ready(self, run: Callable[[SourceT], None], source: SourceT) -> Callable[[], None]:
        """Return the function that a source calls whenever one more message or request waits."""
        return partial(self.ready.append, partial(run, source))

    def clear(self) -> None:
        """Stop running callbacks."""
        self._cleared = True
        self.ready.clear()
        self.subscriptions.clear()
        self.services.clear()
        self.timers.clear()

    def run_ready(self) -> bool:
        """Run every callback that is ready; return whether there was one."""
        has_run, left = False, len(self.ready)  # timers run before what arrives meanwhile
        while left and self.ready:
            try:
                run = self.ready.popleft()
            except IndexError:  # another thread spins too
                break
            run()
            has_run = True
            left -= 1
            if left and not self._go_on():
                break
        return self._run_timers() or has_run if self.timers else has_run

    def time(self) -> int:
        """Return the timers' time [ns]: simulated time, or else a monotonic clock's."""
        is_simulated = isinstance(self.clock, ManualClock)
        return self.clock.now() if is_simulated else time.monotonic_ns()

    def busy(self) -> int:
        """Return the time spent in callbacks so far [ns]; callable from any thread."""
        stopwatches = [one.stopwatch for one in tuple(self.subscriptions)]
        stopwatches += [one.stopwatch for one in tuple(self.services)]
        return self._timed.busy() + sum(stopwatch.busy() for stopwatch in stopwatches)

    def time_to_timer(self, *others: Timer) -> float | None:
        """Return the time until the next timer [s], ``others`` included.

        None if only a message can bring work.
        """
        if not (self.timers or others) or isinstance(self.clock, ManualClock):
            return None
        now = self.time()
        waits = [wait for t in (*self.timers, *others) if (wait := t.remaining(now)) is not None]
        return min(waits, default=None)

    def next_due(self) -> int:
        """Return the simulated time at which the next timer is due [ns]; ``NEVER`` without one."""
        if not isinstance(self.clock, ManualClock):
            return NEVER
        timers = (*self.timers, self.awaited) if self.awaited else self.timers
        return min((timer.due() for timer in timers), default=NEVER)

    def deliver(self, subscription: Subscription) -> None:
        """Run the callback of the oldest waiting message."""
        payload = subscription.pop()
        if payload is not None:  # else the subscription was destroyed meanwhile
            self.run(subscription, payload)

    def run(self, subscription: Subscription, payload: bytes) -> None:
        """Run a subscription's callback; meanwhile its thread does not wait for others."""
        turn, watch = self.turn, subscription.stopwatch
        thread, turn.thread = turn.thread, 0
        watch.calls += 1  # as ``with watch``, without calls
        watch.began.append(time.monotonic_ns())
        try:
            try:
                message = subscription.decode(payload)
            except DecodeError as error:
                if subscription.is_warning_due(time.monotonic()):
                    self._logger.warning(f"{subscription.topic}: message ignored: {error}")
                return
            subscription.callback(message)
        except Exception as error:  # noqa: BLE001 - a node outlives its callbacks' faults
            self._note(subscription.topic, error, subscription.callback)
        finally:
            watch.end()
            turn.thread, turn.has_run = thread, True

    def answer(self, service: Service[Message, Message]) -> None:
        """Run the callback of the oldest waiting request."""
        request = service.pop_request()
        if request is None:
            return
        with service.stopwatch:
            failure = service.answer(request)
        if failure is not None:
            is_hidden = service.name.endswith(PARAMETERS_SUFFIX)
            name = "parameters" if is_hidden else f"service {service.name}"
            self._errors.add(name, failure, service.callback)

    def _run_timers(self) -> bool:
        has_run = False
        for timer in tuple(self.timers):
            now = self.time()
            # an earlier timer may have ended the node or the program
            if self._go_on() and not self._cleared and timer.is_due(now):
                timer.advance(now)
                has_run = True
                with self._timed:
                    try:
                        timer.callback()
                    except Exception as error:  # noqa: BLE001 - a node outlives its callbacks' faults
                        self._note(str(timer), error, timer.callback)
        return has_run

    def _note(self, name: str, error: Exception, callback: Callable[..., object]) -> None:
        if isinstance(error, LcmtoolsError) and not self._go_on():
            return  # not a fault: a call failed because the program is ending
        self._errors.add(name, error, callback)
