"""A recorded run of a lab: the robot's motion and the programs' messages in a log."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

from lcmtools.bag.log import Log
from lcmtools.clock import CLOCK_TOPIC
from lcmtools.errors import LcmtoolsError
from lcmtools.labs.catalogue import Lab, LabProgram
from lcmtools.labs.checks.observations import (
    CommandMessage,
    Desire,
    Observations,
    TrueState,
    seconds,
)
from lcmtools.labs.checks.path import LEAST_POSES
from lcmtools.messages.registry import Message
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry, Path
from lcmtools.types.rosgraph_msgs import Clock
from lcmtools.types.rosgraph_msgs import Log as LogMessage

LOG_TOPIC, PATH = "/rosout", "/path"

MessageT = TypeVar("MessageT", bound=Message)


@dataclass(frozen=True, slots=True)
class RecordedMessage:
    """A message in a log, with its simulated time and the time of its recording [s]."""

    time: float
    arrival: float
    message: Message


@dataclass(slots=True)
class RecordedRun:
    """All messages of a lab's topics in a log, in the order of their recording."""

    lab: Lab
    topics: dict[str, list[RecordedMessage]] = field(default_factory=dict)  # the messages by topic
    end: float = 0.0  # the time of the log's last message [s]

    def name(self, topic: str) -> str:
        """Return the full name of a topic of the robot."""
        return f"{self.lab.robot.rstrip('/')}/{topic}"

    def messages(self, topic: str, cls: type[MessageT]) -> Iterator[tuple[float, MessageT]]:
        """Yield the messages of a type on a topic, with their simulated times [s]."""
        for recorded in self.topics.get(topic, ()):
            if isinstance(recorded.message, cls):
                yield recorded.time, recorded.message

    def motion(self, *topics: str) -> list[TrueState]:
        """Return the robot's motion from the first of these topics that is in the log."""
        for topic in topics:
            if found := [
                TrueState.by(odometry) for _, odometry in self.messages(self.name(topic), Odometry)
            ]:
                return found
        return []

    def desired(self) -> list[Desire]:
        """Return the desired velocities, without repetitions."""
        found: list[Desire] = []
        for time, twist in self.messages(self.name("desired_velocity"), Twist):
            forward, turn_rate = twist.linear.x, twist.angular.z
            if not found or (found[-1].forward, found[-1].turn_rate) != (forward, turn_rate):
                found.append(Desire(time, forward, turn_rate))
        return found

    def commands(self, program: LabProgram) -> list[CommandMessage]:
        """Return the messages on the topics that a program must publish."""
        found = [
            CommandMessage(recorded.time, topic, recorded.message)
            for topic in program.publishes
            for recorded in self.topics.get(topic, ())
        ]
        return sorted(found, key=lambda command: command.time)

    def path(self) -> list[tuple[float, float]]:
        """Return the points of the first path that has some [m]."""
        for _, message in self.messages(PATH, Path):
            if len(message.poses) >= LEAST_POSES:
                return [(one.pose.position.x, one.pose.position.y) for one in message.poses]
        return []

    def observations(self, program: LabProgram) -> Observations:
        """Return the observations of a program's run in the log."""
        logs = self.messages(LOG_TOPIC, LogMessage)
        return Observations(
            program,
            self.commands(program),
            self.desired(),
            self.motion("ground_truth", "odometry"),
            warnings=[
                log.msg
                for _, log in logs
                if log.level >= LogMessage.WARN and log.name == self.lab.simulator
            ],
        )

    def pace(self) -> float:
        """Return simulated seconds per recorded second; 1 if unknown."""
        found = self.topics.get(self.name("odometry")) or self.topics.get(CLOCK_TOPIC) or []
        if len(found) < 2 or found[-1].arrival <= found[0].arrival:  # noqa: PLR2004 - no span
            return 1.0
        span = found[-1].time - found[0].time
        return span / (found[-1].arrival - found[0].arrival) or 1.0


def known_topics(lab: Lab, log: Log) -> list[str]:
    """Return the topics of a lab that are in a log; LcmtoolsError if it has none."""
    known = [topic for topic in _topics(RecordedRun(lab)) if topic in log.topics]
    if not {*known} - {CLOCK_TOPIC, LOG_TOPIC}:
        what = f"{log.path} has no topic of the lab {lab.name}"
        raise LcmtoolsError(what, f"lcmtools bag info {log.path} shows what it has")
    return known


def read_run(lab: Lab, log: Log) -> RecordedRun:
    """Read a lab's run from a log; LcmtoolsError if it has none of the lab's topics."""
    run, known = RecordedRun(lab, end=log.end / 1e9), known_topics(lab, log)
    now = 0.0
    for arrival in log.messages(*known, on_error=lambda _: None):
        now = _simulated(arrival.message, now)
        message = RecordedMessage(now, arrival.time / 1e9, arrival.message)
        run.topics.setdefault(arrival.topic, []).append(message)
    return run


def _topics(run: RecordedRun) -> Sequence[str]:
    names = [topic for program in run.lab.programs for topic in program.publishes]
    names += [topic for one in run.lab.programs for topic in one.subscribes if "image" not in topic]
    names += map(run.name, ("desired_velocity", "odometry", "ground_truth"))
    return *dict.fromkeys(names), CLOCK_TOPIC, LOG_TOPIC, PATH


def _simulated(message: Message, now: float) -> float:
    """Return the simulated time given by a message, which never goes back."""
    if isinstance(message, Clock):
        return max(now, seconds(message.clock))
    return max(now, seconds(message.header.stamp)) if isinstance(message, Odometry) else now
