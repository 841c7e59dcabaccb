"""The test bench of a lab's check: a bus of its own, a simulator, and an observer.

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
from typing import TypeVar

import lcmtools
from lcmtools import Node
from lcmtools.errors import LcmtoolsError, MissingExtra
from lcmtools.labs.catalogue import Lab
from lcmtools.labs.checks.programs import CheckedProgram
from lcmtools.messages.registry import Message
from lcmtools.processes.process_guard import ProcessGuard
from lcmtools.types.rosgraph_msgs import Clock
from lcmtools.types.sim_msgs import SetPose

_START_TIMEOUT = 30.0
"""Time that a simulator has to start [s]."""
_GROUP = "239.255.76.67"
_SPIN_TIME = 0.05
_OTHER_BUSES = ("LCMTOOLS_DOMAIN", "LCMTOOLS_NAMESPACE")

MessageT = TypeVar("MessageT", bound=Message)


class TestBench:
    """A simulator with a lab's world, on a bus of its own.

    Args:
        lab: The lab.
        rate: Simulated seconds per second.

    Attributes:
        node: The observer, which also commands the robot.
        folder: For files of the check; it goes away with the bench.
        time: Simulated time [s].
    """

    node: Node
    folder: Path

    def __init__(self, lab: Lab, rate: float) -> None:
        self.lab = lab
        self.rate = rate
        self.time = 0.0
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
        """Start a program on this bus; it ends with the bench at the latest.

        Raises:
            UsageError: It cannot be started.
        """
        self._programs += 1
        output = self.folder / f"output_{self._programs}"
        program = CheckedProgram(
            command, self._environment(), output, self._guard, has_keys=has_keys
        )
        return self._owned.enter_context(program)

    def subscribe(
        self,
        message_type: type[MessageT] | tuple[type[MessageT], ...],
        topic: str,
        callback: Callable[[MessageT], object],
    ) -> None:
        """Have a callback called with each message of a topic, while ``wait`` runs."""
        self.node.create_subscription(message_type, topic, callback, 100)

    def record(self, message_type: type[MessageT], topic: str) -> list[MessageT]:
        """Return a list to which each message of a topic is appended, while ``wait`` runs."""
        messages: list[MessageT] = []
        self.subscribe(message_type, topic, messages.append)
        return messages

    def wait(self, condition: Callable[[], object], timeout: float) -> bool:
        """Call callbacks until a condition is true; return False if it was not in time [s]."""
        deadline = time.monotonic() + timeout
        while not condition():
            left = deadline - time.monotonic()
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
        self._set_pose = self.node.create_client(SetPose, f"{self.lab.simulator}/set_pose")
        self.subscribe(Clock, "/clock", self._take_clock)
        world = ("--world", self.lab.world, "--rate", f"{self.rate:g}")
        simulator = self.start(("lcmtools", "run", "sim", *world))
        self.wait(lambda: self.time > 0.0 or simulator.code is not None, _START_TIMEOUT)
        if not self.time > 0.0:
            reason = simulator.last_line() or f"it printed nothing for {_START_TIMEOUT:g} s"
            is_missing = simulator.code == MissingExtra.exit_code
            error = MissingExtra if is_missing else LcmtoolsError
            raise error(f"the simulator did not start: {reason}")

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
