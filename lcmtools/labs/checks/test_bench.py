"""The test bench of a lab's check: its own bus, a simulator, and an observer that records.

However it ends, nothing is left: a guard ends its process groups, and its files are in a temporary
folder.
"""

import contextlib
import os
import socket
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import lcmtools
from lcmtools import Node
from lcmtools.errors import LcmtoolsError, MissingExtra
from lcmtools.labs.catalogue import Lab, LabProgram
from lcmtools.labs.checks.bus_look import look_at_bus
from lcmtools.labs.checks.checked_programs import CheckedProgram, own_path
from lcmtools.labs.checks.observations import BusLook, Observations, last_words
from lcmtools.labs.checks.recorder import BUMPER, Recorder
from lcmtools.processes.process_guard import ProcessGuard
from lcmtools.types.rosgraph_msgs import Log
from lcmtools.types.sim_msgs import SetPose, SetRate
from lcmtools.types.std_srvs import Trigger

_START_TIMEOUT = 30.0  # time that a simulator has to start [s]
_GROUP = "239.255.76.67"
_SPIN_TIME = 0.05
_OTHER_BUSES = ("LCMTOOLS_DOMAIN", "LCMTOOLS_NAMESPACE")
AFTER_END = 0.5  # [s] for messages that a program sent before it ended
_SLOWEST_PRINT = 15.0  # [s] for the simulator to print a world's file
_ANSWER_TIMEOUT = 5.0  # [s] for the simulator to answer a service's call


class TimeLimitReached(Exception):  # noqa: N818 - no error: a result
    """The time limit of a check has passed."""


class TestBench:
    """A simulator with a lab's world, on its own bus.

    It runs at ``rate`` simulated seconds per second (None: as suits the program), for at most
    ``time_limit`` [s] of real time.
    """

    node: Node  # the observer, which also commands the robot
    folder: Path  # for files of the check; it goes away with the bench
    program: CheckedProgram | None = None  # the program under check, once it is started

    def __init__(
        self,
        lab: Lab,
        program: LabProgram,
        rate: float | None = None,
        time_limit: float = float("inf"),
    ) -> None:
        self.lab = lab
        self.world: dict[str, Any] = {}  # the world file's content
        self._first_rate = rate or program.rate
        self.recorder = Recorder(lab, program, self._first_rate)
        self._has_fixed_rate = rate is not None
        self._deadline = time.monotonic() + time_limit
        self._bus_look: BusLook | None = None
        self._url = f"udpm://{_GROUP}:{_free_port()}?ttl=0"
        self._owned = contextlib.ExitStack()
        self._programs = 0
        self._simulator: CheckedProgram | None = None

    def __enter__(self) -> "TestBench":
        """Start the simulator and wait until it runs.

        Raises:
            MissingExtra: The simulator is not installed.
            LcmtoolsError: It does not start; the error has its last line.
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

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.recorder.time

    @property
    def rate(self) -> float:
        """Simulated seconds per second."""
        return self.recorder.rate

    def start(self, command: Sequence[str], *, has_keys: bool = False) -> CheckedProgram:
        """Start the program under check on this bus, after ending an earlier one.

        It ends with the bench at the latest.

        Raises:
            UsageError: It cannot be started.
        """
        self._running.close()
        self.recorder.forget()
        self.program = self._running.enter_context(self._start(command, has_keys=has_keys))
        return self.program

    def running(self) -> CheckedProgram:
        """Return the program under check, which has been started."""
        assert self.program is not None
        return self.program

    def look_again(self) -> None:
        """Forget how the bus looked when it was last observed."""
        self._bus_look = None

    def observe(self) -> Observations:
        """Return the observations so far; the bus is observed once while the program runs."""
        program = self.running()
        if self._bus_look is None and program.code is None:
            self._bus_look = look_at_bus(self._url, program.pid)
            lcmtools.spin_once(self.node)  # what came meanwhile, with the time
        return replace(
            self.recorder.observations(),
            printed=program.printed(),
            code=None if program.was_interrupted else program.code,
            look=self._bus_look,
        )

    def wait(self, condition: Callable[[], object], timeout: float) -> bool:
        """Call callbacks until a condition is true; return False after the timeout [s].

        The timeout is short once the program under check has ended.

        Raises:
            TimeLimitReached: The time limit of the check is over.
            LcmtoolsError: The simulator has ended, which is no fault of the program.
        """
        deadline = time.monotonic() + timeout
        has_ended = False
        while not condition():
            if self._simulator is not None and self._simulator.code is not None:
                raise self._ended(self._simulator)
            now = time.monotonic()
            if now > self._deadline:
                raise TimeLimitReached
            if not has_ended and self.program and self.program.code is not None:
                has_ended, deadline = True, min(deadline, now + AFTER_END)
            left = deadline - now
            if left <= 0:
                return False
            lcmtools.spin_once(self.node, min(left, _SPIN_TIME))
        return True

    def reset_pose(self) -> None:
        """Move the robot to the origin, at rest; LcmtoolsError if the simulator refuses."""
        request = SetPose.Request()
        request.robot = self.lab.robot
        request.pose.orientation.w = 1.0
        self._check(self._set_pose.call(request, _ANSWER_TIMEOUT))

    def start_again(self) -> None:
        """End the program and restart the simulation.

        Raises:
            LcmtoolsError: The simulator refuses.
        """
        self._running.close()
        before = self.time
        self._check(self._reset.call(Trigger.Request(), _ANSWER_TIMEOUT))
        self.wait(lambda: self.time < before, _ANSWER_TIMEOUT)

    def set_rate(self, rate: float) -> None:
        """Change the rate of simulated time; LcmtoolsError if the simulator refuses."""
        request = SetRate.Request()
        request.rate = rate
        self._check(self._set_rate.call(request, _ANSWER_TIMEOUT))
        self.recorder.rate = rate

    def has_slowed_down(self) -> bool:
        """Switch to real time; return False if it is so already, or the user chose the rate."""
        if self._has_fixed_rate or self.rate <= 1.0:
            return False
        self.set_rate(1.0)
        return True

    def speed_up(self) -> None:
        """Return to the initial rate."""
        self.set_rate(self._first_rate)

    def _check(self, response: SetPose.Response | SetRate.Response | Trigger.Response) -> None:
        if not response.success:
            raise LcmtoolsError(f"{self.lab.simulator}: {response.message}")

    def _start(self, command: Sequence[str], *, has_keys: bool = False) -> CheckedProgram:
        self._programs += 1
        output = self.folder / f"output_{self._programs}"
        environment = self._environment()
        return CheckedProgram(command, environment, output, self._guard, has_keys=has_keys)

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
        self._reset = self.node.create_client(Trigger, f"{self.lab.simulator}/reset")
        self._set_rate = self.node.create_client(SetRate, f"{self.lab.simulator}/set_rate")
        self.recorder.listen(self.node)
        world = ("--world", self._world_file(), "--rate", f"{self._first_rate:g}")
        words = ("lcmtools", "run", "lcmtools", "sim", *world)
        simulator = self._owned.enter_context(self._start(words))
        self._simulator = simulator
        self._running = self._owned.enter_context(contextlib.ExitStack())
        if not self.wait(lambda: self.time > 0.0, _START_TIMEOUT):
            raise self._ended(simulator)

    def _ended(self, simulator: CheckedProgram) -> LcmtoolsError:
        """Return the error for a simulator that did not start, or that ended during the check."""
        reason = last_words(simulator.printed()) or f"it printed nothing for {_START_TIMEOUT:g} s"
        if self.time > 0.0:
            what = f"the simulator ended during the check, with code {simulator.code}: {reason}"
            return LcmtoolsError(what, "this says nothing about the program: check it again")
        is_missing = simulator.code == MissingExtra.exit_code
        error = MissingExtra if is_missing else LcmtoolsError
        return error(f"the simulator did not start: {reason}")

    def _world_file(self) -> str:
        """Write the lab's world with a bumper around the robot that reports contacts."""
        words = ("lcmtools", "run", "lcmtools", "sim", "--print-world", self.lab.world)
        printer = self._owned.enter_context(self._start(words))
        if not printer.wait(_SLOWEST_PRINT) or printer.code:
            return self.lab.world  # starting it will show the reason
        import yaml

        self.world = yaml.safe_load(printer.printed())
        for robot in self.world["robots"]:
            robot.setdefault("sensors", []).append({"type": "bumper", "topic": BUMPER})
        file = self.folder / f"{self.lab.world}.yaml"
        file.write_text(yaml.safe_dump(self.world), encoding="utf-8")
        return str(file)

    def _environment(self) -> dict[str, str]:
        """Return a program's environment: this bus, this Python first, unbuffered output."""
        here = {name: text for name, text in os.environ.items() if name not in _OTHER_BUSES}
        ours = {"LCM_DEFAULT_URL": self._url, "PATH": own_path(), "PYTHONUNBUFFERED": "1"}
        return {**here, **ours, "NO_COLOR": "1", "TERM": "xterm"}


def _free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("", 0))
        return int(probe.getsockname()[1])
