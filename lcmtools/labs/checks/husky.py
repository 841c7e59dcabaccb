"""The Husky lab: the step responses of a controller, and the statistics of an evaluator."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from lcmtools.labs.checks.measures import BAND, Response, analyse, is_within
from lcmtools.labs.checks.programs import CheckResult
from lcmtools.labs.checks.test_bench import TestBench
from lcmtools.messages.registry import Message
from lcmtools.types.air_lab0 import ControllerEvaluationStat
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import JointState

_ROBOT = "/husky0"
_COMMANDS = ("wheel_cmd", "velocity_cmd", "wheel_velocity_cmd")
_REPEAT = 0.2  # [s] a desired velocity is repeated: LCM loses messages, and programs start late
_LONGEST, _STEADY = 8.0, 2.0  # [s] simulated
_SLOW = 0.02  # [m/s] or [rad/s]: at rest
_FIRST_MESSAGE = 10.0  # [s]
_SOME = 6  # messages


@dataclass(frozen=True, slots=True)
class Step:
    """A desired velocity, from rest: forward speed [m/s] and turn rate [rad/s]."""

    forward: float
    turn_rate: float

    @property
    def target(self) -> float:
        """The one of both that is not 0."""
        return self.forward or self.turn_rate

    @property
    def unit(self) -> str:
        """The target's unit."""
        return "m/s" if self.forward else "rad/s"

    @property
    def title(self) -> str:
        """The step in words."""
        return f"{'drive' if self.forward else 'turn'} at {self.target:g} {self.unit}"


_STEPS = (Step(0.1, 0.0), Step(0.5, 0.0), Step(1.0, 0.0), Step(0.0, 0.3))
_REST = Step(0.0, 0.0)


class _Robot:
    """The Husky, commanded by its desired velocity and observed by odometry."""

    def __init__(self, bench: TestBench) -> None:
        self._publisher = bench.node.create_publisher(Twist, f"{_ROBOT}/desired_velocity")
        self._samples: list[tuple[float, float, float]] = []
        self.commands = 0
        self._desired = Twist()
        bench.subscribe(Odometry, f"{_ROBOT}/odometry", self._take_odometry)
        for name in _COMMANDS:
            bench.subscribe((JointState, Twist), f"{_ROBOT}/{name}", self._count)
        bench.subscribe(Twist, f"{_ROBOT}/cmd_vel", self._count)
        bench.node.create_timer(_REPEAT, self._publish)

    def desire(self, step: Step) -> None:
        """Publish a desired velocity, and forget what was measured before."""
        self._desired.linear.x, self._desired.angular.z = step.forward, step.turn_rate
        self._publish()
        self._samples.clear()

    def samples(self, step: Step) -> list[tuple[float, float]]:
        """Return the time since the first sample [s], and the velocity of the step's kind."""
        return [
            (time - self._samples[0][0], forward if step.forward else turn_rate)
            for time, forward, turn_rate in self._samples
        ]

    def is_at_rest(self) -> bool:
        """Return True if the newest odometry is of a robot that does not move."""
        return bool(self._samples) and max(map(abs, self._samples[-1][1:])) < _SLOW

    def _take_odometry(self, odometry: Odometry) -> None:
        stamp, twist = odometry.header.stamp, odometry.twist.twist
        self._samples.append((stamp.sec + stamp.nsec / 1e9, twist.linear.x, twist.angular.z))

    def _count(self, _command: Message) -> None:
        self.commands += 1

    def _publish(self) -> None:
        self._publisher.publish(self._desired)


def check_controller(bench: TestBench, command: Sequence[str]) -> Iterator[CheckResult]:
    """Check a controller of the Husky's speed."""
    robot = _Robot(bench)
    program = bench.start(command)
    robot.desire(_REST)
    bench.wait(lambda: robot.commands or program.code is not None, _FIRST_MESSAGE)
    what, wanted = "commands the robot", "messages that come"
    if not robot.commands:
        hint = (
            f"does it publish on {_ROBOT}/velocity_cmd or wheel_cmd, once it has odometry and a"
            " desired velocity? lcmtools wtf beside it shows what is not connected"
        )
        yield program.nothing_within(_FIRST_MESSAGE, what, wanted, hint)
        return
    yield CheckResult(what, wanted, "they come", is_ok=True)
    for step in _STEPS:
        if program.code is not None:
            yield program.early_end(step.title)
            return
        yield _drive(bench, robot, step)
        if step == _STEPS[-2]:
            yield _stop(bench, robot)
    yield program.check_ctrl_c()


def _drive(bench: TestBench, robot: _Robot, step: Step) -> CheckResult:
    robot.desire(_REST)
    bench.wait(robot.is_at_rest, _LONGEST / bench.rate)
    bench.reset_pose(_ROBOT)
    robot.desire(step)

    def is_over() -> bool:
        samples = robot.samples(step)
        if not samples:
            return False
        settled = analyse(samples, step.target).settled_after
        now = samples[-1][0]
        return now > _LONGEST or (settled is not None and now - settled > _STEADY)

    bench.wait(is_over, 2 * _LONGEST / bench.rate + 5.0)
    samples = robot.samples(step)
    wanted = f"{step.target:g} {step.unit} within {BAND:.0%}"
    if not samples:
        hint = "does the simulator still run?"
        return CheckResult(step.title, wanted, "no odometry", is_ok=False, hint=hint)
    response = analyse(samples, step.target)
    settled = response.settled_after
    after = "never settled" if settled is None else f"settled after {settled:.1f} s"
    measured = f"{response.reached:.3f} {step.unit}, {after}, overshoot {response.overshoot:.0%}"
    is_ok = settled is not None and is_within(response.reached, step.target)
    return CheckResult(step.title, wanted, measured, is_ok, _advice(response, step))


def _advice(response: Response, step: Step) -> str:
    part = response.reached / step.target
    if part < -BAND:
        return "it goes the wrong way: the signs, or left and right, are exchanged"
    if part < BAND:
        return "it does not move: an effort below the dead band, or is desired_velocity not read?"
    if part < 1 - BAND:
        return "too slow: let the effort grow as long as the speed is too low"
    if part > 1 + BAND:
        return "too fast: let the effort shrink as long as the speed is too high"
    return "it swings around the target: a smaller gain, or smaller steps of the effort"


def _stop(bench: TestBench, robot: _Robot) -> CheckResult:
    robot.desire(_REST)
    start = bench.time
    stopped = bench.wait(robot.is_at_rest, 2 * _LONGEST / bench.rate + 2.0)
    seconds = bench.time - start
    return CheckResult(
        "stop from 1 m/s",
        f"0 m/s within {_LONGEST:g} s",
        f"at rest after {seconds:.1f} s" if stopped else "still moves",
        is_ok=stopped and seconds <= _LONGEST,
        hint="a desired velocity of 0 is one like any other",
    )


def check_evaluator(bench: TestBench, command: Sequence[str]) -> Iterator[CheckResult]:
    """Check a node that evaluates a controller, with a robot at rest."""
    stats = bench.record(ControllerEvaluationStat, f"{_ROBOT}/evaluation_stat")
    robot = _Robot(bench)
    program = bench.start(command)
    desired = Step(0.3, 0.4)
    error = math.hypot(desired.forward, desired.turn_rate)
    robot.desire(desired)
    bench.wait(lambda: len(stats) >= _SOME or program.code is not None, _FIRST_MESSAGE)
    if not stats:
        hint = (
            f"does it read odometry and desired_velocity, and publish {_ROBOT}/evaluation_stat?"
            " lcmtools node info shows its names"
        )
        yield program.nothing_within(_FIRST_MESSAGE, "publishes", "messages that come", hint)
        return
    first, last = stats[0].samples, stats[-1].samples
    yield CheckResult(
        "samples",
        "1 more each time",
        f"{first} to {last} in {len(stats)} messages",
        is_ok=last - first == len(stats) - 1,
        hint="count in the odometry callback, and only there: one message for each odometry",
    )
    yield _error_result("last_error", stats[-1].last_error, error)
    yield _error_result("average_error", stats[-1].average_error, error)
    robot.desire(_REST)
    bench.wait(lambda: stats[-1].last_error < error / 100, 3.0)
    yield _error_result("last_error at the goal", stats[-1].last_error, 0.0)
    yield CheckResult(
        "average_error remembers",
        f"between 0 and {error:g}",
        f"{stats[-1].average_error:.3f}",
        is_ok=0.0 < stats[-1].average_error < error,
        hint="it is the average of all samples, not of the last one",
    )
    yield program.check_ctrl_c()


def _error_result(what: str, measured: float, wanted: float) -> CheckResult:
    is_ok = math.isclose(measured, wanted, rel_tol=0.02, abs_tol=0.005)
    hint = "the root of (v - desired v)^2 + (w - desired w)^2"
    return CheckResult(what, f"{wanted:.3f}", f"{measured:.3f}", is_ok, hint)
