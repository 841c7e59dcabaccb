"""Between the simulation and the bus: the only module that knows nodes, topics and publishers."""

import time
from collections.abc import Callable

from lcmtools import Node, spin_once
from lcmtools.errors import ValueMismatch
from lcmtools.messages.registry import Message
from lcmtools.node.publisher import Publisher
from lcmtools.node.subscription import Subscription
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import JointState
from lcmtools_sim.readings import Interest, Sample
from lcmtools_sim.robot import Robot
from lcmtools_sim.simulation import CLOCK_TOPIC, Simulation

Command = JointState | Twist

_TYPES: dict[bool, tuple[type[Command], ...]] = {
    False: (JointState, Twist),
    True: (Twist, JointState),
}
"""What a command topic takes, the declared type first; by whether that is Twist."""

_LOOK_PERIOD = 0.1
"""[s] How long a new listener may wait for the first picture, and who looks for the clock."""


class Bridge:
    """Takes commands from the bus to the robots, and samples from the simulation to the bus.

    Args:
        node: The simulator's node.
        simulation: What is simulated.
    """

    def __init__(self, node: Node, simulation: Simulation) -> None:
        self._node = node
        self._simulation = simulation
        self._complaints: dict[str, set[str]] = {}
        self._publishers: dict[str, Publisher[Message]] = {}
        self._subscriptions: dict[Robot, list[Subscription]] = {}
        self._heard: tuple[frozenset[str], bool] = frozenset(), True
        self._next_look = 0.0
        self._shown_time = simulation.time
        self.refresh()

    def receive(self, timeout: float = 0.0) -> None:
        """Hand over the commands that have come, and answer calls; wait so long at most [s]."""
        spin_once(self._node, timeout)
        now = time.monotonic()
        if now >= self._next_look:
            self._next_look = now + _LOOK_PERIOD
            self._take_in(self._node.has_plain_listeners())
            self._show_time()

    def look(self) -> None:
        """Find out at once who listens: steps that somebody asks for do not wait for it."""
        self._take_in(self._node.has_plain_listeners(at_once=True))

    def publish(self, samples: list[Sample]) -> None:
        """Send a step's messages."""
        for sample in samples:
            self._publishers[sample.topic].publish_payload(sample.payload)

    def warn(self, text: str) -> None:
        """Log a warning of the simulator."""
        self._node.get_logger().warning(text)

    def refresh(self) -> None:
        """Publish and subscribe for the robots that are there now."""
        topics, robots = self._simulation.topics(), self._simulation.robots
        for topic in self._publishers.keys() - topics.keys():
            self._node.destroy_publisher(self._publishers.pop(topic))
        for topic, message_type in topics.items():
            if topic not in self._publishers:
                self._publishers[topic] = self._node.create_publisher(message_type, topic)
        for robot in self._subscriptions.keys() - set(robots):
            for subscription in self._subscriptions.pop(robot):
                self._node.destroy_subscription(subscription)
        for robot in robots:
            if robot not in self._subscriptions:
                self._subscriptions[robot] = self._subscribe(robot)
        self._simulation.ask(self._interest)

    def _take_in(self, may_be_overheard: bool) -> None:  # noqa: FBT001 - what the node says
        """Measure what is heard now."""
        heard = self._node.subscribed_topics(), may_be_overheard
        if heard != self._heard:
            self._heard = heard
            self._simulation.ask(self._interest)

    def _show_time(self) -> None:
        """Send the clock although nobody listens to it: who only looks is to find it.

        By the wall clock: at a hundred times real time it would cost as much as the physics.
        """
        time = self._simulation.time
        if CLOCK_TOPIC in self._publishers and not self._simulation.is_clock_heard:
            if time != self._shown_time:
                self.publish([self._simulation.tick()])
            self._shown_time = time

    def _interest(self, topic: str) -> Interest:
        announced, may_be_overheard = self._heard
        if self._publishers[topic].topic in announced:
            return Interest.SURE
        return Interest.POSSIBLE if may_be_overheard else Interest.NONE

    def _subscribe(self, robot: Robot) -> list[Subscription]:
        prefix = robot.namespace.rstrip("/")
        group = f"wheel command of {robot.namespace}"
        made = []
        for command in robot.model.commands:
            topic = f"{prefix}/{command.name}"
            callback = self._commander(robot, self._node.resolve_name(topic))
            types = _TYPES[command.is_twist]
            made.append(self._node.create_subscription(types, topic, callback, group=group))
        return made

    def _commander(self, robot: Robot, topic: str) -> Callable[[Command], None]:
        """The callback of one command topic: obeys, or says once why not."""

        def command(message: Command) -> None:
            try:
                robot.command(message)
            except ValueMismatch as error:
                self._complain(topic, f"{topic}: command ignored: {error}")
            else:
                self._complaints.pop(topic, None)

        return command

    def _complain(self, topic: str, text: str) -> None:
        """Warn of a bad command, once until a good one has come: a publisher repeats its fault."""
        told = self._complaints.setdefault(topic, set())
        if text not in told:
            told.add(text)
            self.warn(text)
