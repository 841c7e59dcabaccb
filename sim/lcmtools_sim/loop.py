"""The simulator's loop: receive commands, do one step, publish messages, wait for the next step."""

from collections.abc import Callable
from typing import Protocol

from lcmtools_sim.mounted import Sample
from lcmtools_sim.schedule import Pacer
from lcmtools_sim.simulation import Simulation

_PAUSED_WAIT = 0.1
"""[s] The longest delay of a request to end, or of closing the window, while paused."""


class SimulationContext(Protocol):
    """The bus, as far as the loop needs it; see lcmtools_sim.bridge."""

    def receive(self, timeout: float = 0.0) -> None:
        """Handle received messages; wait at most ``timeout`` for them [s]."""

    def find_subscribers(self) -> None:
        """Update the subscribers at once."""

    def publish(self, samples: list[Sample]) -> None:
        """Publish a step's messages."""

    def warn(self, text: str) -> None:
        """Warn the user."""


class Loop:
    """Runs a simulation: by the wall clock, or step by step while it is paused.

    It ends when ``go_on`` returns False, and after ``last_step``, if that is given. A loop that is
    ``paused`` waits for ``step``.
    """

    def __init__(
        self,
        simulation: Simulation,
        context: SimulationContext,
        pacer: Pacer,
        *,
        go_on: Callable[[], bool],
        last_step: int | None = None,
    ) -> None:
        self.paused = False
        self._simulation = simulation
        self._context = context
        self._pacer = pacer
        self._go_on = go_on
        self._last_step = last_step
        self._fell_behind = False

    def run(self) -> None:
        """Run until it should end, or the window is closed."""
        while True:
            self._context.receive(_PAUSED_WAIT if self.paused else 0.0)
            if not self._may_go_on():
                return
            if self.paused:
                self._pacer.restart()
            else:
                self._step()
                self._wait()

    def step(self, count: int) -> int:
        """Do a number of steps without waiting; return the number of steps done."""
        self._context.find_subscribers()
        for done in range(count):
            if not self._may_go_on():
                return done
            self._step()
        return count

    def set_rate(self, rate: float) -> None:
        """Set the rate of simulated time relative to real time; 0 for as fast as possible."""
        self._pacer.period = self._simulation.scene.dt / rate if rate else 0.0
        self._pacer.restart()
        self._fell_behind = False

    def _may_go_on(self) -> bool:
        left = self._last_step is None or self._simulation.steps < self._last_step
        return left and self._go_on() and self._simulation.is_open()

    def _step(self) -> None:
        self._context.publish(self._simulation.step())

    def _wait(self) -> None:
        dropped = self._pacer.wait(lambda: self._go_on() and not self.paused, self._context.receive)
        if dropped and not self._fell_behind:
            self._fell_behind = True
            self._context.warn(
                f"the computer is too slow for this rate: {dropped:.2f} s were dropped, and"
                " simulated time falls behind from now on; a lower --rate keeps it even"
            )
