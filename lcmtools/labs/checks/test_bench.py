"""The test bench of a lab's check: a bus of its own, a simulator, and an observer that records.

Nothing of it is left when it is over, however it ends: processes are in groups that their guard
knows, and files in a folder that goes away.
"""

import contextlib
import os
import socket
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

import lcmtools
from lcmtools import Node
from lcmtools.errors import LcmtoolsError, MissingExtra
from lcmtools.labs.catalogue import Lab, LabProgram
from lcmtools.labs.checks.bus_look import look_at_bus
from lcmtools.labs.checks.observations import (
    BusLook,
    Command,
    Desire,
    Observations,
    Sample,
    Touch,
    last_words,
)
from lcmtools.labs.checks.programs import CheckedProgram
from lcmtools.messages.registry import Message
from lcmtools.processes.process_guard import ProcessGuard
from lcmtools.types.gazebo_msgs import ContactsState
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.rosgraph_msgs import Clock, Log
from lcmtools.types.sim_msgs import SetPose

_START_TIMEOUT = 30.0
"""Time that a simulator has to start [s]."""
_GROUP = "239.255.76.67"
_SPIN_TIME = 0.05
_OTHER_BUSES = ("LCMTOOLS_DOMAIN", "LCMTOOLS_NAMESPACE")
_BUMPER = "lab_bumper"
_AFTER_END = 0.5  # [s] for messages that a program sent before it ended
_SLOWEST_PRINT = 15.0  # [s] for the simulator to print a world's file
_DEPTH = 1000  # messages that wait while the bus is looked at

MessageT = TypeVar("MessageT", bound=Message)


class TimeLimitReached(Exception):  # noqa: N818 - no error: a result
    """The time limit of a check is over."""


class TestBench:
    """A simulator with a lab's world, on a bus of its own.

    Args:
        lab: The lab.
        program: The program of it that is checked.
        rate: Simulated seconds per second.
        directory: The program's working directory; "" for this process's.
        time_limit: Real time for all of it [s].

    Attributes:
        node: The observer, which also commands the robot.
        folder: For files of the check; it goes away with the bench.
        time: Simulated time [s].
        commands: Messages on the topics that the program is to publish.
        motion: The robot's true motion.
        desired: The velocities that were desired.
        touches: The robot's contacts.
        world: The world file's content.
        path: The path that the robot is to follow [m], set by its check.
    """

    node: Node
    folder: Path
    program: CheckedProgram | None = None

    def __init__(
        self,
        lab: Lab,
        program: LabProgram,
        rate: float,
        directory: str = "",
        time_limit: float = float("inf"),
    ) -> None:
        self.lab = lab
        self.rate = rate
        self.time = 0.0
        self.world: dict[str, Any] = {}
        self.commands: list[Command] = []
        self.desired: list[Desire] = []
        self.motion: list[Sample] = []
        self.touches: list[Touch] = []
        self.path: Sequence[tuple[float, float]] = ()
        self._lab_program = program
        self._directory = directory
        self._deadline = time.monotonic() + time_limit
        self._warnings: list[str] = []
        self._look: BusLook | None = None
        self._url = f"udpm://{_GROUP}:{_free_port()}?ttl=0"
        self._owned = contextlib.ExitStack()
        self._programs = 0

    def __enter__(self) -> "TestBench":
        """Start the simulator and wait until it runs.

        Raises:
            MissingExtra: The simulator is not installed.
            LcmtoolsError: It does not start, with its last line.
        """
        try:
            self._set_up()
        except BaseException:
            self._owned.close()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        """End everything."""
        self._owned.close()

    def start(self, command: Sequence[str], *, has_keys: bool = False) -> CheckedProgram:
        """Start the program under check on this bus; it ends with the bench at the latest.

        Raises:
            UsageError: It cannot be started.
        """
        self.program = self._start(command, self._directory, has_keys=has_keys)
        return self.program

    def observe(self) -> Observations:
        """Return what has been observed so far; the bus is looked at once, if it runs."""
        program = self.program
        assert program is not None
        if self._look is None and program.code is None:
            self._look = look_at_bus(self._url, program.pid)
        return Observations(
            self._lab_program,
            self.commands,
            self.desired,
            self.motion,
            self.touches,
            self._warnings,
            program.printed(),
            None if program.was_interrupted else program.code,
            self._look,
            self.path,
        )

    def _start(
        self, command: Sequence[str], directory: str = "", *, has_keys: bool = False
    ) -> CheckedProgram:
        self._programs += 1
        output = self.folder / f"output_{self._programs}"
        program = CheckedProgram(
            command, self._environment(), output, self._guard, directory, has_keys=has_keys
        )
        return self._owned.enter_context(program)

    def subscribe(
        self,
        message_type: type[MessageT] | tuple[type[MessageT], ...],
        topic: str,
        callback: Callable[[MessageT], object],
    ) -> None:
        """Have a callback called with each message of a topic, while ``wait`` runs."""
        self.node.create_subscription(message_type, topic, callback, _DEPTH)

    def record(self, message_type: type[MessageT], topic: str) -> list[MessageT]:
        """Return a list to which each message of a topic is appended, while ``wait`` runs."""
        messages: list[MessageT] = []
        self.subscribe(message_type, topic, messages.append)
        return messages

    def wait(self, condition: Callable[[], object], timeout: float) -> bool:
        """Call callbacks until a condition is true; return False if it was not in time [s].

        Once the program under check has ended, little time is left.

        Raises:
            TimeLimitReached: The time limit of the check is over.
        """
        deadline = time.monotonic() + timeout
        has_ended = False
        while not condition():
            now = time.monotonic()
            if now > self._deadline:
                raise TimeLimitReached
            if not has_ended and self.program and self.program.code is not None:
                has_ended, deadline = True, min(deadline, now + _AFTER_END)
            left = deadline - now
            if left <= 0:
                return False
            lcmtools.spin_once(self.node, min(left, _SPIN_TIME))
        return True

    def reset_pose(self, robot: str) -> None:
        """Put a robot at the origin, at rest.

        Raises:
            LcmtoolsError: The simulator does not do it.
        """
        request = SetPose.Request()
        request.robot = robot
        request.pose.orientation.w = 1.0
        response = self._set_pose.call(request, 5.0)
        if not response.success:
            raise LcmtoolsError(f"{self.lab.simulator}: {response.message}")

    def _set_up(self) -> None:
        folder = tempfile.TemporaryDirectory(prefix="lcmtools-lab-")
        self.folder = Path(self._owned.enter_context(folder))
        self._guard = self._owned.enter_context(ProcessGuard())
        lcmtools.init([], url=self._url, handle_signals=False)
        self._owned.callback(lcmtools.shutdown)
        self.node = self._owned.enter_context(Node(f"_lcmtools_lab_{os.getpid()}", tool=True))
        # what it cannot read, it has to judge, and not to warn of
        self.node.get_logger().threshold = Log.ERROR
        self._set_pose = self.node.create_client(SetPose, f"{self.lab.simulator}/set_pose")
        self.subscribe(Clock, "/clock", self._take_clock)
        self._record()
        world = ("--world", self._world_file(), "--rate", f"{self.rate:g}")
        simulator = self._start(("lcmtools", "run", "lcmtools", "sim", *world))
        self.wait(lambda: self.time > 0.0 or simulator.code is not None, _START_TIMEOUT)
        if not self.time > 0.0:
            reason = (
                last_words(simulator.printed()) or f"it printed nothing for {_START_TIMEOUT:g} s"
            )
            is_missing = simulator.code == MissingExtra.exit_code
            error = MissingExtra if is_missing else LcmtoolsError
            raise error(f"the simulator did not start: {reason}")

    def _record(self) -> None:
        """Record what the robot does, and the simulator's warnings."""
        robot = self.lab.robot.rstrip("/")
        self.subscribe(Odometry, f"{robot}/ground_truth", self._take_motion)
        self.subscribe(ContactsState, f"{robot}/{_BUMPER}", self._take_contacts)
        self.subscribe(Log, "/rosout", self._take_log)

    def record_command(self, message_type: type[MessageT] | tuple[type[MessageT], ...]) -> None:
        """Record the messages on the topics that the program is to publish."""
        for topic in self._lab_program.publishes:

            def take(message: MessageT, topic: str = topic) -> None:
                self.commands.append(Command(self.time, topic, message))

            self.subscribe(message_type, topic, take)

    def _take_motion(self, odometry: Odometry) -> None:
        place, twist = odometry.pose.pose.position, odometry.twist.twist
        self.motion.append(Sample(self.time, place.x, place.y, twist.linear.x, twist.angular.z))

    def _take_contacts(self, contacts: ContactsState) -> None:
        place = self.motion[-1] if self.motion else Sample(0.0, 0.0, 0.0, 0.0, 0.0)
        self.touches += [
            Touch(self.time, state.collision2_name, place.x, place.y) for state in contacts.states
        ]

    def _take_log(self, log: Log) -> None:
        if log.level >= Log.WARN and log.name == self.lab.simulator:
            self._warnings.append(log.msg)

    def _world_file(self) -> str:
        """Write the lab's world with a bumper around the robot, which tells what it touches."""
        printer = self._start(
            ("lcmtools", "run", "lcmtools", "sim", "--print-world", self.lab.world)
        )
        if not printer.wait(_SLOWEST_PRINT) or printer.code:
            return self.lab.world  # starting it will show the reason
        import yaml

        self.world = yaml.safe_load(printer.printed())
        for robot in self.world["robots"]:
            robot.setdefault("sensors", []).append({"type": "bumper", "topic": _BUMPER})
        file = self.folder / f"{self.lab.world}.yaml"
        file.write_text(yaml.safe_dump(self.world), encoding="utf-8")
        return str(file)

    def _take_clock(self, clock: Clock) -> None:
        self.time = clock.clock.sec + clock.clock.nsec / 1e9

    def _environment(self) -> dict[str, str]:
        """Return a program's environment: this bus, this Python first, unbuffered output."""
        here = {name: text for name, text in os.environ.items() if name not in _OTHER_BUSES}
        path = os.pathsep.join((str(Path(sys.executable).parent), os.environ.get("PATH", "")))
        ours = {"LCM_DEFAULT_URL": self._url, "PATH": path, "PYTHONUNBUFFERED": "1"}
        return {**here, **ours, "NO_COLOR": "1"}


def _free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("", 0))
        return int(probe.getsockname()[1])
