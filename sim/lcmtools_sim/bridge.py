"""Between the simulation and the bus: nodes, topics and publishers."""

import time
from collections.abc import Callable

from lcmtools import Node, spin_once
from lcmtools.errors import ValueMismatch
from lcmtools.messages.registry import Message
from lcmtools.node.publisher import Publisher
from lcmtools.node.subscription import Subscription
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import JointState
from lcmtools_sim.mounted import Sample, Subscribers
from lcmtools_sim.robot import Robot
from lcmtools_sim.simulation import CLOCK_TOPIC, Simulation

Command = JointState | Twist

_TYPES: dict[bool, tuple[type[Command], ...]] = {
    False: (JointState, Twist),
    True: (Twist, JointState),
}
"""The types of a command topic, the declared one first; by whether that is Twist."""

_UPDATE_PERIOD = 0.1
"""[s] The longest delay of the first picture for a new subscriber, and of an idle clock."""


class Bridge:
    """Passes commands from the bus to the robots, and samples from the simulation to the bus."""

    def __init__(self, node: Node, simulation: Simulation) -> None:
        self._node = node
        self._simulation = simulation
        self._warnings: dict[str, set[str]] = {}
        self._publishers: dict[str, Publisher[Message]] = {}
        self._subscriptions: dict[Robot, list[Subscription]] = {}
        self._subscribed: tuple[frozenset[str], bool] = frozenset(), True
        self._next_update = 0.0
        self._published_time = simulation.time
        self.refresh()

    def receive(self, timeout: float = 0.0) -> None:
        """Handle received commands and service calls; wait at most ``timeout`` for them [s]."""
        spin_once(self._node, timeout)
        now = time.monotonic()
        if now >= self._next_update:
            self._next_update = now + _UPDATE_PERIOD
            self.find_subscribers(at_once=False)
            self._publish_idle_clock()

    def find_subscribers(self, *, at_once: bool = True) -> None:
        """Select the topics with subscribers; ``at_once`` looks for programs that are no nodes."""
        may_have_others = self._node.has_plain_listeners(at_once=at_once)
        subscribed = self._node.subscribed_topics(), may_have_others
        if subscribed != self._subscribed:
            self._subscribed = subscribed
            self._simulation.select(self._subscribers)

    def publish(self, samples: list[Sample]) -> None:
        """Publish a step's messages."""
        for sample in samples:
            self._publishers[sample.topic].publish_payload(sample.payload)

    def warn(self, text: str) -> None:
        """Log a warning of the simulator."""
        self._node.get_logger().warning(text)

    def refresh(self) -> None:
        """Publish and subscribe for the present robots."""
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
        self._simulation.select(self._subscribers)

    def _publish_idle_clock(self) -> None:
        """Publish the clock even without a subscriber, so that it appears on the bus.

        By the wall clock: at a hundred times real time it would cost as much as the physics.
        """
        time = self._simulation.time
        if CLOCK_TOPIC in self._publishers and not self._simulation.publishes_clock:
            if time != self._published_time:
                self.publish([self._simulation.tick()])
            self._published_time = time

    def _subscribers(self, topic: str) -> Subscribers:
        announced, may_have_others = self._subscribed
        if self._publishers[topic].topic in announced:
            return Subscribers.KNOWN
        return Subscribers.POSSIBLE if may_have_others else Subscribers.NONE

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
        """The callback of one command topic."""

        def command(message: Command) -> None:
            try:
                robot.command(message)
            except ValueMismatch as error:
                self._warn_once(topic, f"{topic}: command ignored: {error}")
            else:
                self._warnings.pop(topic, None)

        return command

    def _warn_once(self, topic: str, text: str) -> None:
        """Warn of a bad command, once until a good one: a publisher repeats its fault."""
        given = self._warnings.setdefault(topic, set())
        if text not in given:
            given.add(text)
            self.warn(text)
