"""The simulator's loop: commands in, one step, messages out, wait for the next moment."""

from collections.abc import Callable
from typing import Protocol

from lcmtools_sim.readings import Sample
from lcmtools_sim.schedule import Pacer
from lcmtools_sim.simulation import Simulation

_PAUSED_WAIT = 0.1
"""[s] How long a paused loop may overlook a request to end, or a window that was closed."""


class Surroundings(Protocol):
    """What the loop needs of the bus; see lcmtools_sim.bridge."""

    def receive(self, timeout: float = 0.0) -> None:
        """Hand over what has come; wait for it so long at most [s]."""

    def look(self) -> None:
        """Find out at once who listens."""

    def publish(self, samples: list[Sample]) -> None:
        """Send a step's messages."""

    def warn(self, text: str) -> None:
        """Tell the user."""


class Loop:
    """Lets a simulation go on: by the wall clock, or step by step while it is paused.

    Args:
        simulation: What goes on.
        surroundings: Where commands come from and messages go.
        pacer: When a step may run.
        go_on: Whether it should.
        last_step: Where it ends by itself; None for never.

    Attributes:
        paused: It waits for ``step``.
    """

    def __init__(
        self,
        simulation: Simulation,
        surroundings: Surroundings,
        pacer: Pacer,
        *,
        go_on: Callable[[], bool],
        last_step: int | None = None,
    ) -> None:
        self.paused = False
        self._simulation = simulation
        self._surroundings = surroundings
        self._pacer = pacer
        self._go_on = go_on
        self._last_step = last_step
        self._fell_behind = False

    def run(self) -> None:
        """Go on until it should end, its last step is done or its window is closed."""
        while True:
            self._surroundings.receive(_PAUSED_WAIT if self.paused else 0.0)
            if not self._may_go_on():
                return
            if self.paused:
                self._pacer.restart()
            else:
                self._step()
                self._wait()

    def step(self, count: int) -> int:
        """Do so many steps at once, without waiting; return how many were done."""
        self._surroundings.look()
        for done in range(count):
            if not self._may_go_on():
                return done
            self._step()
        return count

    def set_rate(self, rate: float) -> None:
        """Let simulated time pass so much faster than real time; 0 for as fast as possible."""
        self._pacer.period = self._simulation.scene.dt / rate if rate else 0.0
        self._pacer.restart()
        self._fell_behind = False

    def _may_go_on(self) -> bool:
        left = self._last_step is None or self._simulation.steps < self._last_step
        return left and self._go_on() and self._simulation.is_open()

    def _may_wait(self) -> bool:
        return self._go_on() and not self.paused

    def _step(self) -> None:
        self._surroundings.publish(self._simulation.step())

    def _wait(self) -> None:
        dropped = self._pacer.wait(self._may_wait, self._surroundings.receive)
        if dropped and not self._fell_behind:
            self._fell_behind = True
            self._surroundings.warn(
                f"the computer is too slow for this rate: {dropped:.2f} s were dropped, and"
                " simulated time falls behind from now on; a lower --rate keeps it even"
            )
