"""The recorder of a lab's run: a program's commands, the robot's motion, the simulator's warnings.

It records a bus, by a node, or a log, and only listens, without any judgement.
"""

import time
from typing import TypeVar

from lcmtools import Node
from lcmtools.bag.log import Log
from lcmtools.clock import CLOCK_TOPIC
from lcmtools.errors import LcmtoolsError
from lcmtools.labs.catalogue import Lab, LabProgram
from lcmtools.labs.checks.observations import (
    Desire,
    Observations,
    ReceivedMessage,
    Touch,
    TrueState,
    seconds,
)
from lcmtools.messages.registry import Message, type_name
from lcmtools.types.gazebo_msgs import ContactsState
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry, Path
from lcmtools.types.rosgraph_msgs import Clock
from lcmtools.types.rosgraph_msgs import Log as LogMessage

BUMPER = "lab_bumper"  # the topic, below the robot's, of the contacts that a check's world adds
PATH, _LOG_TOPIC = "/path", "/rosout"
DEPTH = 1000  # messages that wait while the bus is looked at
LEAST_POSES = 2  # of a path

MessageT = TypeVar("MessageT", bound=Message)


class Recorder:
    """The messages of a lab's run, for one of its programs.

    On a bus they come while the bench's node, the observer, spins; a check asks for those that only
    it needs by ``receive``, ``record`` and ``record_command``. A log has all of them.
    """

    def __init__(self, lab: Lab, program: LabProgram, rate: float = 1.0) -> None:
        self.lab, self.program = lab, program
        self.rate = rate  # simulated seconds per second: now, or on average in a log
        self.time = 0.0  # simulated [s]
        self.duration = 0.0  # simulated time that has passed, each part divided by its rate [s]
        self.end = 0.0  # the time of a log's last message [s]
        self.received: list[ReceivedMessage] = []  # all messages
        self.commands: list[ReceivedMessage] = []  # on the topics that the program is to publish
        self.desired: list[Desire] = []  # the velocities, without repetitions
        self.truth: list[TrueState] = []  # the robot's motion
        self.odometry: list[TrueState] = []  # the motion that the robot measures
        self.touches: list[Touch] = []  # the robot's contacts
        self.warnings: list[str] = []  # of the simulator
        self.path: list[tuple[float, float]] = []  # the first one with some points [m]
        self._node: Node | None = None

    @property
    def motion(self) -> list[TrueState]:
        """The robot's motion, as it is known best."""
        return self.truth or self.odometry

    def name(self, topic: str) -> str:
        """Return the full name of a topic of the robot."""
        return f"{self.lab.robot.rstrip('/')}/{topic}"

    def listen(self, node: Node) -> None:
        """Record the bus of a node, which is to spin."""
        self._node = node
        self.receive(CLOCK_TOPIC, Clock)
        self.receive(self.name("ground_truth"), Odometry)
        self.receive(self.name(BUMPER), ContactsState)
        self.receive(_LOG_TOPIC, LogMessage)

    def receive(self, topic: str, *message_types: type[Message]) -> None:
        """Record a topic of the bus, too."""
        assert self._node is not None

        def take(message: Message) -> None:
            self.take(topic, message, time.monotonic())

        self._node.create_subscription(message_types, topic, take, DEPTH)

    def forget(self) -> None:
        """Discard everything recorded so far, but for the path."""
        for values in (self.received, self.commands, self.desired, self.truth, self.odometry,
                       self.touches, self.warnings):  # fmt: skip
            values.clear()

    def record(self, message_type: type[MessageT], topic: str) -> list[MessageT]:
        """Return a list that grows with each message on a topic of the bus."""
        assert self._node is not None
        messages: list[MessageT] = []
        self._node.create_subscription(message_type, topic, messages.append, DEPTH)
        return messages

    def record_command(self, *message_types: type[Message]) -> None:
        """Record the messages on the bus's topics that the program must publish."""
        for topic in self.program.publishes:
            self.receive(topic, *message_types)

    def take(self, topic: str, message: Message, arrival: float) -> None:
        """Record a message that arrived at a time of the computer, or of a log [s]."""
        self._update_time(message)
        received = ReceivedMessage(self.time, topic, message, arrival)
        self.received.append(received)
        if topic in self.program.publishes:
            if type_name(message) in self.program.types:
                self.commands.append(received)
        elif isinstance(message, Odometry):
            is_true = topic == self.name("ground_truth")
            (self.truth if is_true else self.odometry).append(TrueState.by(message))
        elif isinstance(message, Twist):
            self.desire(message.linear.x, message.angular.z)
        elif isinstance(message, Path) and not self.path and len(message.poses) >= LEAST_POSES:
            places = (pose.pose.position for pose in message.poses)
            self.path = [(place.x, place.y) for place in places]
        elif isinstance(message, ContactsState):
            self._take_contacts(message)
        elif isinstance(message, LogMessage):
            self._take_log(message)

    def desire(self, forward: float, turn_rate: float) -> None:
        """Record a velocity that is desired from now on [m/s], [rad/s]."""
        last = self.desired[-1] if self.desired else None
        if last is None or (last.forward, last.turn_rate) != (forward, turn_rate):
            self.desired.append(Desire(self.time, forward, turn_rate))

    def observations(self) -> Observations:
        """Return the observations so far; a bench adds its own."""
        return Observations(
            self.program,
            self.commands,
            self.desired,
            self.motion,
            self.touches,
            self.warnings,
            path=self.path,
        )

    def _update_time(self, message: Message) -> None:
        if isinstance(message, Clock):
            now = seconds(message.clock)
        elif isinstance(message, Odometry) and self._node is None:  # a log may have no clock
            now = seconds(message.header.stamp)
        else:
            return
        passed = max(0.0, now - self.time)
        self.duration += passed / self.rate
        # a reset of the simulation, which a bench may ask for, sets it back
        self.time = now if self._node else self.time + passed

    def _take_log(self, log: LogMessage) -> None:
        if log.level >= LogMessage.WARN and log.name == self.lab.simulator:
            self.warnings.append(log.msg)

    def _take_contacts(self, contacts: ContactsState) -> None:
        place = self.motion[-1] if self.motion else TrueState(0.0, 0.0, 0.0, 0.0, 0.0)
        self.touches += [
            Touch(seconds(contacts.header.stamp), state.collision2_name, place.x, place.y)
            for state in contacts.states
        ]


def known_topics(lab: Lab, log: Log) -> list[str]:
    """Return the topics of a lab that are in a log; LcmtoolsError if it has none."""
    robot, programs = lab.robot.rstrip("/"), lab.programs
    names = [topic for program in programs for topic in program.publishes]
    names += [topic for one in programs for topic in one.subscribes if "image" not in topic]
    names += [f"{robot}/{topic}" for topic in ("desired_velocity", "odometry", "ground_truth")]
    known = [name for name in (*dict.fromkeys(names), PATH) if name in log.topics]
    if not known:
        what = f"{log.path} has no topic of the lab {lab.name}"
        raise LcmtoolsError(what, f"lcmtools bag info {log.path} shows what it has")
    return known + [name for name in (CLOCK_TOPIC, _LOG_TOPIC) if name in log.topics]


def read_log(lab: Lab, log: Log) -> list[Recorder]:
    """Return a log's record for each program; LcmtoolsError if it has no topic of the lab."""
    recorders = [Recorder(lab, program) for program in lab.programs]
    topics = known_topics(lab, log)
    for arrival in log.messages(*topics, on_error=lambda _: None):
        for recorder in recorders:
            recorder.take(arrival.topic, arrival.message, arrival.time / 1e9)
    for recorder in recorders:
        recorder.end, recorder.rate = log.end / 1e9, _pace(recorder)
    return recorders


def _pace(recorder: Recorder) -> float:
    """Return simulated seconds per recorded second; 1 if unknown."""
    for topic in (recorder.name("odometry"), CLOCK_TOPIC):
        if found := [received for received in recorder.received if received.topic == topic]:
            span = found[-1].arrival - found[0].arrival
            return (found[-1].time - found[0].time) / span or 1.0 if span > 0 else 1.0
    return 1.0
