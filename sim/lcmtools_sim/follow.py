"""One of several processes that simulate one world together: it follows the leader's clock.

With ``--only`` each process simulates some of the world's robots; the one that has the first robot
leads and publishes /clock, the others step up to its time. Each has all objects of the world for
itself, and robots of different processes neither meet nor see each other.
"""

from collections.abc import Callable

from lcmtools import Node, spin_once
from lcmtools.clock import NANOSECONDS
from lcmtools.types.rosgraph_msgs import Clock
from lcmtools_sim.schedule import Pacer
from lcmtools_sim.simulation import CLOCK_TOPIC, Simulation

_LONGEST_WAIT = 0.1  # [s]; the longest delay of a request to end


class LeaderClock(Pacer):
    """Lets steps run up to the leader's /clock.

    If the leader started before this process, the simulation begins at the leader's time; if its
    clock goes back (a reset, or a new leader), it starts again there, and ``on_restart`` is called:
    its robots are other objects then.
    """

    def __init__(self, node: Node, simulation: Simulation, on_restart: Callable[[], None]) -> None:
        super().__init__(period=0.0)
        self._node = node
        self._simulation = simulation
        self._on_restart = on_restart
        self._leader: int | None = None
        node.create_subscription(Clock, CLOCK_TOPIC, self._receive)

    def restart(self) -> None:
        """Do nothing: a follower is never late."""

    def wait(self, go_on: Callable[[], bool], meanwhile: Callable[[], None]) -> float:
        """Wait until the leader has reached the next step, or ``go_on`` returns False."""
        while go_on() and not self._may_step():
            spin_once(self._node, _LONGEST_WAIT)
            meanwhile()
        return 0.0

    def _may_step(self) -> bool:
        return self._leader is not None and self._simulation.steps < self._steps(self._leader)

    def _receive(self, message: Clock) -> None:
        now = message.clock.sec * NANOSECONDS + message.clock.nsec
        if self._leader is None or now < self._leader:
            self._simulation.reset(self._steps(now))
            self._on_restart()
        self._leader = now

    def _steps(self, time: int) -> int:
        """The number of steps in a time [ns]; stamps are rounded, so nearly one is one."""
        return int(time / NANOSECONDS / self._simulation.scene.dt + 1e-3)
