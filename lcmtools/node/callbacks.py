"""The callbacks that the spinning thread runs: of subscriptions, services and timers.

Exceptions of user code end here, in ``CallbackErrors``. A node's name and announcements are not
known here.
"""

import time
from collections.abc import Callable

from lcmtools.clock import Clock, ManualClock, SystemClock
from lcmtools.errors import DecodeError, LcmtoolsError
from lcmtools.messages.registry import Message
from lcmtools.node.callback_errors import CallbackErrors
from lcmtools.node.logger import Logger
from lcmtools.node.parameters import PARAMETERS_SUFFIX
from lcmtools.node.service import Service
from lcmtools.node.stopwatch import Stopwatch
from lcmtools.node.subscription import Subscription
from lcmtools.node.timer import Timer


class Callbacks:
    """The callbacks of one node, run while ``go_on`` returns True; ``errors`` takes exceptions."""

    def __init__(self, logger: Logger, errors: CallbackErrors, go_on: Callable[[], bool]) -> None:
        self.subscriptions: list[Subscription] = []
        self.services: list[Service[Message, Message]] = []
        self.timers: list[Timer] = []
        self.clock: Clock = SystemClock()
        """The node's clock; timers follow it where it is simulated time."""
        self.spinning_thread: int | None = None
        """The thread on which ``spin`` runs them now."""
        self._timed = Stopwatch()
        self._logger = logger
        self._errors = errors
        self._go_on = go_on
        self._cleared = False
        self._has_waiting = False

    def note_message(self) -> None:
        """Note that a message or a request waits; called on the thread that receives."""
        self._has_waiting = True

    def clear(self) -> None:
        """Run nothing any more."""
        self._cleared = True
        self.subscriptions.clear()
        self.services.clear()
        self.timers.clear()

    def run_ready(self) -> int:
        """Run every callback that is ready; return their number."""
        ran = self._run_waiting() if self._has_waiting else 0
        return ran + self._run_timers() if self.timers else ran

    def time(self) -> int:
        """Return the timers' time [ns]: simulated, or else of a monotonic clock."""
        if isinstance(self.clock, ManualClock):
            return self.clock.now()
        return time.monotonic_ns()

    def busy(self) -> int:
        """Return the time spent in callbacks so far [ns]; callable from any thread."""
        stopwatches = [one.stopwatch for one in tuple(self.subscriptions)]
        stopwatches += [one.stopwatch for one in tuple(self.services)]
        return self._timed.busy() + sum(stopwatch.busy() for stopwatch in stopwatches)

    def time_to_timer(self, *others: Timer) -> float | None:
        """Return the time until the next timer [s], one of ``others`` too.

        None if only a message can bring work.
        """
        if not (self.timers or others) or isinstance(self.clock, ManualClock):
            return None
        now = self.time()
        waits = [wait for t in (*self.timers, *others) if (wait := t.remaining(now)) is not None]
        return min(waits, default=None)

    def _run_waiting(self) -> int:
        """Run the callbacks of waiting messages and requests."""
        self._has_waiting = False  # before checking: a message from now on sets it again
        try:
            return self._run_subscriptions() + self._run_services()
        except BaseException:  # Ctrl-C in a callback: more may wait
            self._has_waiting = True
            raise

    def _run_subscriptions(self) -> int:
        ran = 0
        for subscription in tuple(self.subscriptions):
            for _ in range(subscription.waiting()):
                payload = subscription.take()
                if payload is None or not self._is_running():
                    break
                with subscription.stopwatch:
                    self._deliver(subscription, payload)
                ran += 1
        return ran

    def _deliver(self, subscription: Subscription, payload: bytes) -> None:
        try:
            message = subscription.decode(payload)
        except DecodeError as error:
            if subscription.is_warning_due(time.monotonic()):
                self._logger.warning(f"{subscription.topic}: message ignored: {error}")
            return
        self._guard(subscription.topic, subscription.callback, message)

    def _run_services(self) -> int:
        ran = 0
        for service in tuple(self.services):
            while self._is_running() and (request := service.take()) is not None:
                ran += 1
                with service.stopwatch:
                    failure = service.answer(request)
                if failure is not None:
                    is_hidden = service.name.endswith(PARAMETERS_SUFFIX)
                    name = "parameters" if is_hidden else f"service {service.name}"
                    self._errors.add(name, failure, service.callback)
        return ran

    def _run_timers(self) -> int:
        ran = 0
        for timer in tuple(self.timers):
            now = self.time()
            if self._is_running() and timer.is_due(now):
                timer.advance(now)
                with self._timed:
                    self._guard(str(timer), timer.callback)
                ran += 1
        return ran

    def _is_running(self) -> bool:
        """True if callbacks may be called; one of them may have ended the node or the program."""
        return self._go_on() and not self._cleared

    def _guard(self, name: str, function: Callable[..., object], *arguments: object) -> None:
        """Call user code; log and count its exceptions, and go on."""
        try:
            function(*arguments)
        except Exception as error:  # noqa: BLE001 - a node outlives its callbacks' faults
            if isinstance(error, LcmtoolsError) and not self._go_on():
                return  # no fault: the program ends, and its calls with it
            self._errors.add(name, error, function)
