"""Several processes that simulate one world together: followers follow the leader's clock.

With ``--only``, each process simulates some of the world's robots. The one that has the first robot
leads and publishes /clock; the others step up to its time and acknowledge it, and the leader waits
for all of them before its next step. LCM may lose either message, so both are repeated while a
process waits. Each process has its own copy of all objects of the world, and robots of different
processes neither meet nor see each other.
"""

import time
from collections.abc import Callable

from lcmtools import Node, spin_once
from lcmtools.clock import CLOCK_TOPIC, NANOSECONDS, split_stamp
from lcmtools.types.rosgraph_msgs import Clock
from lcmtools.types.std_msgs import Header
from lcmtools_sim.bridge import Bridge
from lcmtools_sim.schedule import Pacer
from lcmtools_sim.simulation import Simulation

_ACKNOWLEDGEMENT_TOPIC = f"{CLOCK_TOPIC}/_followed"
"""Header: the leader's time that a follower has simulated, and its node's name as frame_id."""
_LONGEST_WAIT = 0.1  # [s]; the longest delay of a request to end, and between repetitions
_SILENCE = 1.0  # [s] after which the leader checks whether a follower still runs


class Followers:
    """The followers of a leader: before its next step, all must have simulated its last one."""

    def __init__(self, node: Node, simulation: Simulation, bridge: Bridge) -> None:
        self._node, self._simulation, self._bridge = node, simulation, bridge
        self._acknowledged: dict[str, int] = {}  # the leader's time that each has simulated [ns]
        self._heard: dict[str, float] = {}
        self._missed: set[str] = set()  # silent ones that are waited for, and already reported
        node.create_subscription(Header, _ACKNOWLEDGEMENT_TOPIC, self._receive)

    def wait(self, go_on: Callable[[], bool]) -> bool:
        """Wait until all of them have simulated the current time, or ``go_on`` returns False.

        Returns True after a long wait, which this process must not make up for.
        """
        is_long = False
        repeat = time.monotonic() + _LONGEST_WAIT
        while (late := self._late()) and go_on():
            self._bridge.publish_clock()
            spin_once(self._node, _LONGEST_WAIT)
            if time.monotonic() >= repeat:
                is_long, repeat = True, time.monotonic() + _LONGEST_WAIT
                self._bridge.publish([self._simulation.tick()])
                now = time.monotonic()
                for name in [name for name in late if now - self._heard[name] >= _SILENCE]:
                    self._miss(name)
        return is_long

    def _late(self) -> list[str]:
        now = self._simulation.time
        return [name for name, reached in self._acknowledged.items() if reached != now]

    def _receive(self, message: Header) -> None:
        name, stamp = message.frame_id, message.stamp
        self._acknowledged[name] = stamp.sec * NANOSECONDS + stamp.nsec
        self._heard[name] = time.monotonic()
        self._missed.discard(name)

    def _miss(self, name: str) -> None:
        """Drop a silent follower if it has ended; else warn that the leader waits for it."""
        if self._has_ended(name):
            del self._acknowledged[name]
            self._bridge.warn(f"{name} has ended: the simulation goes on without it")
        elif name not in self._missed:
            self._missed.add(name)
            self._bridge.warn(f"waiting for {name}, which does nothing: is it paused or stopped?")

    def _has_ended(self, name: str) -> bool:
        from lcmtools.observe.reading.senders import is_gone, is_here  # seldom needed

        # An earlier one may have had the same name.
        nodes = [node for node in self._node.graph().nodes if node.name == name]
        return all(is_gone(node) if is_here(node) else node.stale for node in nodes)


class LeaderClock(Pacer):
    """Lets steps run up to the leader's /clock.

    If the leader started before this process, the simulation begins at the leader's time. If its
    clock goes back (a reset, or a new leader), the simulation restarts there and ``on_restart`` is
    called, because its robots are then other objects.
    """

    def __init__(self, node: Node, simulation: Simulation, on_restart: Callable[[], None]) -> None:
        super().__init__(period=0.0)
        self._node, self._simulation, self._on_restart = node, simulation, on_restart
        self._leader: int | None = None
        self._acknowledgements = node.create_publisher(Header, _ACKNOWLEDGEMENT_TOPIC)
        node.create_subscription(Clock, CLOCK_TOPIC, self._receive)

    def restart(self) -> None:
        """Do nothing: a follower is never late."""

    def wait(self, go_on: Callable[[], bool], meanwhile: Callable[[], None]) -> float:
        """Wait until the leader has reached the next step, or ``go_on`` returns False."""
        while go_on() and not self._may_step():
            if self._leader is not None:
                message = Header()
                message.frame_id = self._node.name
                message.stamp.sec, message.stamp.nsec = split_stamp(self._leader)
                self._acknowledgements.publish(message)
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
        """The number of steps in a time [ns]; as stamps are rounded, almost a step is one."""
        return int(time / NANOSECONDS / self._simulation.scene.dt + 1e-3)
