"""The recorder of a check: a program's commands, the robot's motion, the simulator's warnings.

It only listens, without any judgement.
"""

from typing import TypeVar

from lcmtools import Node
from lcmtools.clock import CLOCK_TOPIC
from lcmtools.labs.catalogue import Lab, LabProgram
from lcmtools.labs.checks.observations import CommandMessage, Desire, Touch, TrueState, seconds
from lcmtools.messages.registry import Message
from lcmtools.types.gazebo_msgs import ContactsState
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.rosgraph_msgs import Clock, Log

BUMPER = "lab_bumper"  # the topic, below the robot's, of the contacts that a check's world adds
DEPTH = 1000  # messages that wait while the bus is looked at

MessageT = TypeVar("MessageT", bound=Message)


class Recorder:
    """Records the events on a check's bus while its node, the observer, spins."""

    def __init__(self, node: Node, lab: Lab, program: LabProgram, rate: float) -> None:
        self.rate = rate  # simulated seconds per second, now
        self.time = 0.0  # simulated [s]
        self.duration = 0.0  # simulated time that has passed, each part divided by its rate [s]
        self.commands: list[CommandMessage] = []  # on the topics that the program is to publish
        self.desired: list[Desire] = []  # the velocities
        self.motion: list[TrueState] = []  # the robot's
        self.touches: list[Touch] = []  # the robot's contacts
        self.warnings: list[str] = []  # of the simulator
        self._node, self._program, self._simulator = node, program, lab.simulator
        robot = lab.robot.rstrip("/")
        node.create_subscription(Clock, CLOCK_TOPIC, self._update_time, DEPTH)
        node.create_subscription(Odometry, f"{robot}/ground_truth", self._record_motion, DEPTH)
        node.create_subscription(ContactsState, f"{robot}/{BUMPER}", self._record_contacts, DEPTH)
        node.create_subscription(Log, "/rosout", self._record_warning, DEPTH)

    def forget(self) -> None:
        """Discard everything recorded so far."""
        for values in (self.commands, self.desired, self.motion, self.touches, self.warnings):
            values.clear()

    def record(self, message_type: type[MessageT], topic: str) -> list[MessageT]:
        """Return a list that grows with each message on a topic."""
        messages: list[MessageT] = []
        self._node.create_subscription(message_type, topic, messages.append, DEPTH)
        return messages

    def record_command(self, *message_types: type[Message]) -> None:
        """Record the messages on the topics that the program must publish."""
        for topic in self._program.publishes:

            def append(message: Message, topic: str = topic) -> None:
                self.commands.append(CommandMessage(self.time, topic, message))

            self._node.create_subscription(message_types, topic, append, DEPTH)

    def _update_time(self, clock: Clock) -> None:
        now = seconds(clock.clock)
        self.duration += max(0.0, now - self.time) / self.rate
        self.time = now

    def _record_motion(self, odometry: Odometry) -> None:
        self.motion.append(TrueState.by(odometry))

    def _record_contacts(self, contacts: ContactsState) -> None:
        place = self.motion[-1] if self.motion else TrueState(0.0, 0.0, 0.0, 0.0, 0.0)
        self.touches += [
            Touch(seconds(contacts.header.stamp), state.collision2_name, place.x, place.y)
            for state in contacts.states
        ]

    def _record_warning(self, log: Log) -> None:
        if log.level >= Log.WARN and log.name == self._simulator:
            self.warnings.append(log.msg)
