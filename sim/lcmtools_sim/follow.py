"""One process of several that simulate one world together: it goes as the leader's clock goes.

With ``--only`` each process simulates some of the world's robots; the one that has the first robot
leads and publishes /clock, the others step as far as that says. Each has all the things of the
world for itself, and robots of different processes neither meet nor see each other.
"""

from collections.abc import Callable

from lcmtools import Node, spin_once
from lcmtools.clock import NANOSECONDS
from lcmtools.messages.registry import Message
from lcmtools.types.rosgraph_msgs import Clock
from lcmtools_sim.readings import Sample
from lcmtools_sim.schedule import Pacer
from lcmtools_sim.simulation import CLOCK_TOPIC, Simulation

_LONGEST_WAIT = 0.1  # [s]; how long a request to stop may go unnoticed


class FollowingSimulation(Simulation):
    """A simulation that leaves the clock to another process."""

    def topics(self) -> dict[str, type[Message]]:
        """Every topic of its samples, with the type."""
        return {topic: kind for topic, kind in super().topics().items() if topic != CLOCK_TOPIC}

    def step(self) -> list[Sample]:
        """Let dt pass and return what is due then, but for the clock."""
        return [sample for sample in super().step() if sample.topic != CLOCK_TOPIC]


class LeadersClock(Pacer):
    """Lets steps run as far as the leader's /clock says.

    Where the leader was before this process, the simulation begins at the leader's time; where its
    clock goes back (a reset, or a new leader), it begins anew there.

    Args:
        node: The simulator's node.
        simulation: What follows.
        on_restart: Called when it has begun anew: its robots are others then.

    Attributes:
        period: Means nothing here: the leader sets the pace.
    """

    def __init__(self, node: Node, simulation: Simulation, on_restart: Callable[[], None]) -> None:
        super().__init__(period=0.0)
        self._node = node
        self._simulation = simulation
        self._on_restart = on_restart
        self._leader: int | None = None
        node.create_subscription(Clock, CLOCK_TOPIC, self._hear)

    def restart(self) -> None:
        """Nothing is late here."""

    def wait(self, go_on: Callable[[], bool], meanwhile: Callable[[], None]) -> float:
        """Wait until the leader has come to the next step, or until ``go_on`` says no.

        Args:
            go_on: Whether to wait on.
            meanwhile: What must not wait: called now and then.

        Returns:
            The time that was dropped [s]: none.
        """
        while go_on() and not self._may_step():
            spin_once(self._node, _LONGEST_WAIT)
            meanwhile()
        return 0.0

    def _may_step(self) -> bool:
        return self._leader is not None and self._simulation.steps < self._steps(self._leader)

    def _hear(self, message: Clock) -> None:
        now = message.clock.sec * NANOSECONDS + message.clock.nsec
        if self._leader is None or now < self._leader:
            self._simulation.reset(self._steps(now))
            self._on_restart()
        self._leader = now

    def _steps(self, time: int) -> int:
        """How many steps fit into a time [ns]; stamps are rounded, so nearly one is one."""
        return int(time / NANOSECONDS / self._simulation.scene.dt + 1e-3)
