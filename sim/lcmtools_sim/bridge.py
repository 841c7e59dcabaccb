"""The bridge between the simulation and the bus: nodes, topics and publishers."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field

from lcmtools import Node, spin_once
from lcmtools.clock import CLOCK_TOPIC
from lcmtools.errors import ValueMismatch
from lcmtools.messages.registry import Message
from lcmtools.node.publisher import Publisher, publish_together
from lcmtools.node.subscription import Subscription
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import JointState
from lcmtools_sim.mounted import Sample, Subscribers
from lcmtools_sim.robot import Robot
from lcmtools_sim.robots.model import CommandTopic
from lcmtools_sim.simulation import Simulation

Command = JointState | Twist
_Steered = tuple[str, tuple[CommandTopic, ...]]
"""A robot's namespace and command topics; after a reset another object has them."""
_UPDATE_PERIOD = 0.1  # [s] the longest delay of a new subscriber's first picture, or an idle clock
_REPEAT_PERIOD = 0.5  # [s] between the repetitions of a warning: ``wtf`` listens for about a second


@dataclass(slots=True)
class _Fault:
    """A fault of a topic's commands: the senders already reported, and when to report it next."""

    next_time: float = 0.0
    senders: set[str] = field(default_factory=set)


class Bridge:
    """Passes commands from the bus to the robots, and samples from the simulation to the bus."""

    def __init__(self, node: Node, simulation: Simulation) -> None:
        self._node, self._simulation = node, simulation
        self._faults: dict[tuple[str, str], _Fault] = {}
        """By topic, and the error of an ignored command, or "" for one beyond the limits."""
        self._publishers: dict[str, Publisher[Message]] = {}
        self._robots: dict[_Steered, Robot] = {}
        self._subscriptions: dict[_Steered, list[Subscription]] = {}
        # probes the nodes, which will have answered by the first update
        self._subscribed: tuple[frozenset[str], bool] = node.subscribed_topics(), True
        self._next_update, self._published_time = 0.0, simulation.time
        self.refresh()

    def receive(self, timeout: float = 0.0) -> None:
        """Handle received commands and service calls; wait at most ``timeout`` for them [s]."""
        spin_once(self._node, timeout)
        now = time.monotonic()
        if now >= self._next_update:
            self._next_update = now + _UPDATE_PERIOD
            self.find_subscribers(at_once=False)
            for text in self._simulation.warnings():
                self.warn(text)
            # The clock of a simulation without subscribers is still published, but paced by the
            # wall clock: at a hundred times real time it would cost as much as the physics.
            if not self._simulation.publishes_clock:
                self.publish_clock()

    def find_subscribers(self, *, at_once: bool = True) -> None:
        """Select the topics with subscribers; ``at_once`` checks for plain programs now."""
        may_have_others = self._node.has_plain_listeners(at_once=at_once)
        subscribed = self._node.subscribed_topics(), may_have_others
        if subscribed != self._subscribed:
            self._subscribed = subscribed
            self._simulation.select(self._subscribers)

    def publish(self, samples: list[Sample]) -> None:
        """Publish a step's messages."""
        publishers = self._publishers
        if samples and samples[0].topic == CLOCK_TOPIC:
            clock, *samples = samples
            publishers[CLOCK_TOPIC].publish_payload(clock.payload)
            self._published_time = self._simulation.time
        messages = [(publishers[sample.topic], sample.payload) for sample in samples]
        publish_together(self._node.context.bus, messages)

    def publish_clock(self) -> None:
        """Publish the clock, if its last message has another time."""
        if CLOCK_TOPIC in self._publishers and self._simulation.time != self._published_time:
            self.publish([self._simulation.tick()])

    def warn(self, text: str) -> None:
        """Log a warning of the simulator."""
        self._node.get_logger().warning(text)

    def refresh(self) -> None:
        """Publish and subscribe for the current robots."""
        topics = self._simulation.topics()
        self._robots = {(one.namespace, one.model.commands): one for one in self._simulation.robots}
        for topic in self._publishers.keys() - topics.keys():
            self._node.destroy_publisher(self._publishers.pop(topic))
        for topic, message_type in topics.items():
            if topic not in self._publishers:
                self._publishers[topic] = self._node.create_publisher(message_type, topic)
        for steered in self._subscriptions.keys() - self._robots.keys():
            for subscription in self._subscriptions.pop(steered):
                self._node.destroy_subscription(subscription)
        for steered in self._robots:
            if steered not in self._subscriptions:
                self._subscriptions[steered] = self._subscribe(steered)
        self._simulation.select(self._subscribers)
        self.publish_clock()  # a reset has changed it

    def _subscribers(self, topic: str) -> Subscribers:
        announced, may_have_others = self._subscribed
        if self._publishers[topic].topic in announced:
            return Subscribers.KNOWN
        return Subscribers.POSSIBLE if may_have_others else Subscribers.NONE

    def _subscribe(self, steered: _Steered) -> list[Subscription]:
        namespace, commands = steered
        group = f"wheel command of {namespace}"
        made = []
        for command in commands:
            topic = f"{namespace.rstrip('/')}/{command.name}"
            callback = self._commander(steered, self._node.resolve_name(topic))
            types: tuple[type[Command], ...] = (JointState, Twist)
            if command.is_twist:  # the declared type comes first
                types = (Twist, JointState)
            made.append(self._node.create_subscription(types, topic, callback, group=group))
        return made

    def _commander(self, steered: _Steered, topic: str) -> Callable[[Command], None]:
        def command(message: Command) -> None:
            try:
                reduced = self._robots[steered].command(message)
            except ValueMismatch as error:
                self._warn_of(topic, str(error), f"command ignored: {error}")
                return
            for key in [key for key in self._faults if key[0] == topic and key[1]]:
                del self._faults[key]
            if reduced:
                self._warn_of(topic, "", f"command reduced: {reduced}")

        return command

    def _warn_of(self, topic: str, fault: str, text: str) -> None:
        """Warn of faulty commands once per sender; of ignored ones again after a valid one.

        While the fault lasts, it is repeated on /rosout, for those who look later.
        """
        now = time.monotonic()
        found = self._faults.setdefault((topic, fault), _Fault())
        if now < found.next_time:
            return
        found.next_time = now + _REPEAT_PERIOD
        names = [
            f"a command, process {node.pid}" if node.tool else node.name
            for node, _ in self._node.graph().topic(topic).publishers
        ]
        sender = f" (from {' or '.join(names)})" if names else ""
        line, log = f"{topic}: {text}{sender}", self._node.get_logger()
        # A node's first command can come before its announcement: then it has no name yet.
        is_known = sender in found.senders or found.senders == {""}
        log.repeat(line) if is_known else log.warning(line)
        found.senders.add(sender)
