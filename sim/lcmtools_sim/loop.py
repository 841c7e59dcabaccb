"""The simulator's loop: commands in, one step, messages out, wait for the next moment."""

from collections.abc import Callable
from typing import Protocol

from lcmtools_sim.schedule import Pacer
from lcmtools_sim.simulation import Sample, Simulation


class Surroundings(Protocol):
    """What the loop needs of the bus; see lcmtools_sim.bridge."""

    def receive(self) -> None:
        """Hand over the commands that have come; never waits."""

    def publish(self, samples: list[Sample]) -> None:
        """Send a step's messages."""

    def warn(self, text: str) -> None:
        """Tell the user."""


def run(
    simulation: Simulation,
    surroundings: Surroundings,
    pacer: Pacer,
    *,
    go_on: Callable[[], bool],
    steps: int | None = None,
) -> None:
    """Simulate until ``go_on`` says no, ``steps`` steps are done or the window is closed."""
    fell_behind = False
    while go_on() and (steps is None or simulation.steps < steps):
        surroundings.receive()
        if not simulation.is_open():
            return
        surroundings.publish(simulation.step())
        dropped = pacer.wait(go_on)
        if dropped and not fell_behind:
            fell_behind = True
            surroundings.warn(
                f"the computer is too slow for this rate: {dropped:.2f} s were dropped, and"
                " simulated time falls behind from now on; a lower --rate keeps it even"
            )
