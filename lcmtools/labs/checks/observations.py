"""The record of one program's run: its messages, its output, and the motion of the robot.

Plain values. The test bench fills them; diagnoses, reports and plots read nothing else.
"""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

from lcmtools.labs.catalogue import LabProgram
from lcmtools.messages.registry import Message
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.std_msgs import Time

_TRACEBACK = "Traceback (most recent call last):"
_FRAME = re.compile(r'\s+File "(?P<file>.+)", line (?P<line>\d+)')
_EXCEPTION = re.compile(r"(?P<name>[A-Za-z_][\w.]*)(: (?P<message>.*))?$")
_OF_CPP = (
    re.compile(r"terminate called after throwing an instance of '(.+)'\s+what\(\): *(.*)()"),
    re.compile(r" raised ([\w:]+): (.*) \(([\w.-]+\.(?:cpp|cc|cxx|hpp|h):\d+)\)"),
)
"""Lines that a program in C++ prints of an exception: one that ended it, or of a callback."""
_NOT_THEIRS = re.compile(r"/site-packages/|/lcmtools/|/lib/python|^<")
_LONGEST_LINE = 200


@dataclass(frozen=True, slots=True)
class ReceivedMessage:
    """A message on the bus or in a log, with the simulated time and that of its arrival [s]."""

    time: float
    topic: str
    message: Message
    arrival: float = 0.0


@dataclass(frozen=True, slots=True)
class TrueState:
    """The robot's true state: simulated time [s], place [m], velocity [m/s], [rad/s], and heading.

    The heading is in radians from x, positive to the left.
    """

    time: float
    x: float
    y: float
    forward: float
    turn_rate: float
    heading: float = 0.0

    @classmethod
    def by(cls, odometry: Odometry) -> "TrueState":
        """Return the state in an odometry message."""
        place, turn = odometry.pose.pose.position, odometry.pose.pose.orientation
        time, twist = seconds(odometry.header.stamp), odometry.twist.twist
        heading = 2 * math.atan2(turn.z, turn.w)
        return cls(time, place.x, place.y, twist.linear.x, twist.angular.z, heading)


@dataclass(frozen=True, slots=True)
class Desire:
    """A desired velocity and the simulated time of its start: [s], [m/s], [rad/s]."""

    time: float
    forward: float
    turn_rate: float


@dataclass(frozen=True, slots=True)
class Touch:
    """A contact of the robot: simulated time [s], the touched body, and the place [m]."""

    time: float
    body: str
    x: float
    y: float

    def __str__(self) -> str:
        """Format the body and the place."""
        return f"{self.body}, at ({round(self.x, 1) + 0.0:.1f}, {round(self.y, 1) + 0.0:.1f}) m"


@dataclass(frozen=True, slots=True)
class Failure:
    """An exception of the program: its name, message, "file.py:35", and how often; 0 for unknown.

    ``callback`` is the callback that raised it: "/odometry", "timer 0.1 s"; "" if unknown.
    """

    exception: str
    message: str = ""
    place: str = ""
    count: int = 0
    callback: str = ""

    def __str__(self) -> str:
        """Format it as one line."""
        text = f"{self.exception}: {self.message}" if self.message else self.exception
        return f"{text} ({self.place})" if self.place else text


@dataclass(frozen=True, slots=True)
class Wire:
    """A topic that the program publishes or subscribes to."""

    topic: str
    type: str = ""  # the type's name; "" where not known
    messages: int = 0
    calls: int = 0  # calls of the callback; of a publisher, 0
    longest: float = 0.0  # the longest call, of a running one so far [s]
    busy: float = 0.0  # the time of all calls [s]
    offered: str = ""  # the type that others publish on it, where it cannot take that


@dataclass(frozen=True, slots=True)
class BusLook:
    """The program as seen on the bus."""

    nodes: Sequence[str] = ()  # the names of its nodes
    publications: Sequence[Wire] = ()  # the topics on which it publishes
    subscriptions: Sequence[Wire] = ()  # those that it has subscribed to
    runs_callbacks: bool = False  # a callback of it has been called, a timer's too
    failures: Sequence[Failure] = ()  # exceptions that its nodes announce
    findings: Sequence[str] = ()  # what wtf finds of it, with the remedies


@dataclass(frozen=True, slots=True)
class Observations:
    """All observations of one program's run."""

    program: LabProgram  # which program of the lab it is
    commands: Sequence[ReceivedMessage] = ()  # those on the topics that it must publish
    desired: Sequence[Desire] = ()  # the velocities that were desired of it
    motion: Sequence[TrueState] = ()  # the robot's true motion
    touches: Sequence[Touch] = ()  # the robot's contacts
    warnings: Sequence[str] = ()  # what the simulator warned of
    printed: str = ""  # its output, or the end of it if it is long
    # Its exit code if it ended by itself, negative for a signal; None while it runs.
    code: int | None = None
    look: BusLook | None = None  # its state on the bus; None before it was observed
    # The path that the robot must follow [m]; empty if there is none.
    path: Sequence[tuple[float, float]] = ()


def seconds(stamp: Time) -> float:
    """Convert a stamp to seconds."""
    return float(stamp.sec + stamp.nsec / 1e9)


def last_failure(printed: str) -> Failure | None:
    """Return the last exception with a printed traceback, or of C++; but not that of Ctrl-C."""
    tracebacks = printed.split(_TRACEBACK)[1:] or [f"\n{printed}"] * ("SyntaxError: " in printed)
    found = (failure for text in reversed(tracebacks) if (failure := _failure_in(text)))
    found = (failure for failure in found if failure.exception != "KeyboardInterrupt")
    return next(found, None) or _failure_of_cpp(printed)


def _failure_of_cpp(printed: str) -> Failure | None:
    for pattern in _OF_CPP:
        for name, message, place in reversed(pattern.findall(printed)):
            return Failure(name, message.strip()[:_LONGEST_LINE], place)
    return None


def _failure_in(traceback: str) -> Failure | None:
    place = ""
    for line in traceback.splitlines()[1:]:
        if frame := _FRAME.match(line):
            if not place or not _NOT_THEIRS.search(frame["file"]):
                place = f"{frame['file'].rpartition('/')[2]}:{frame['line']}"
        elif line and not line[0].isspace() and (match := _EXCEPTION.match(line)):
            message = (match["message"] or "")[:_LONGEST_LINE]
            return Failure(match["name"].rpartition(".")[2], message, place)
    return None


def last_words(printed: str) -> str:
    """Return a program's last exception, else its last line, else ""."""
    if failure := last_failure(printed):
        return str(failure)
    lines = [line.strip() for line in printed.splitlines() if line.strip()]
    return lines[-1][:_LONGEST_LINE] if lines else ""
