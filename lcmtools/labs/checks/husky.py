"""The Husky lab: the step responses of a controller, and the statistics of an evaluator."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from lcmtools.errors import LcmtoolsError
from lcmtools.labs.checks.diagnosis import IGNORED, RAISED, SAME, cause_of
from lcmtools.labs.checks.evaluation import (
    Sample,
    Velocity,
    average_rows,
    error_row,
    samples_row,
)
from lcmtools.labs.checks.program_rows import early_end, first, first_command
from lcmtools.labs.checks.results import CheckResult
from lcmtools.labs.checks.step_response import (
    LONGEST,
    REST,
    Step,
    StepRun,
    command_cause,
    is_at_rest,
    judge,
)
from lcmtools.labs.checks.test_bench import TestBench
from lcmtools.types.air_lab0 import ControllerEvaluationStat
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import JointState

_ROBOT = "/husky0"
_REPEAT, _TIMES = 0.2, 5  # [s]; a desired velocity is repeated, for LCM loses messages
_SOME = 6  # messages
_SOME_TIME = 10.0  # [s] in which they are to come
_NEAR = 0.5  # [m]
_REACTION = 3.0  # [s] in which an evaluator is to follow a change
_CIRCLE = 0.4, 0.6  # efforts of the wheels; the robot drives at about 0.5 m/s and 0.2 rad/s
_STEADY, _FLAT = 0.5, 1e-4  # [s] simulated, and the change of the turn rate in it [rad/s]
_LATE = 10.0  # [s] of a check, after which further causes need not be confirmed in real time
FASTEST, _TURN = Step(1.0, 0.0), Step(0.0, 0.3)
_GOAL = Step(0.3, 0.4)  # that an evaluator is to compare with
STEPS = (Step(0.1, 0.0), Step(0.5, 0.0), FASTEST, REST, _TURN)
_LOST = ("speed-sign", "measured", "zero", "weak", "unmoved-linear.x", "stop")
"""Causes after which other speeds would show nothing new."""


class _Robot:
    """The Husky, commanded by its desired velocity and observed by odometry."""

    def __init__(self, bench: TestBench) -> None:
        self._bench = bench
        self._publisher = bench.node.create_publisher(Twist, f"{_ROBOT}/desired_velocity")
        self._samples = bench.recorder.odometry
        self._first_command, self._start = 0, 0.0
        self._desired = Twist()
        self._repeats = 0
        bench.recorder.receive(f"{_ROBOT}/odometry", Odometry)
        bench.node.create_timer(_REPEAT, self._repeat)

    def desire(self, step: Step) -> None:
        """Publish a desired velocity and discard earlier measurements."""
        self._desired.linear.x, self._desired.angular.z = step.forward, step.turn_rate
        self._publisher.publish(self._desired)
        self._repeats = _TIMES
        self._samples.clear()
        seen = self._bench.recorder
        self._first_command = len(seen.commands)
        self._start = seen.motion[-1].time if seen.motion else 0.0
        seen.desire(step.forward, step.turn_rate)

    def run(self, step: Step) -> StepRun:
        """Return the observations since the velocity was desired."""
        seen = self._bench.recorder
        touches = [touch for touch in seen.touches if touch.time > self._start]
        return StepRun(
            step, tuple(self._samples), seen.commands[self._first_command :], touches, seen.rate
        )

    def prepare(self, step: Step) -> None:
        """Bring the robot to rest, or to a speed if the step is a stop."""
        if step == REST:
            self._settle(FASTEST, lambda: self._samples[-1].forward > FASTEST.forward / 2)
        else:
            self._settle(REST, lambda: is_at_rest(self._samples))
            self._bench.reset_pose()
            self._bench.wait(self._is_at_origin, _SOME_TIME)  # messages of before may still come

    def measure(self, step: Step) -> StepRun:
        """Measure a step; the robot must be prepared for it."""
        self.desire(step)
        self._bench.wait(lambda: self.run(step).is_over(), 2 * LONGEST / self._bench.rate + 5.0)
        return self.run(step)

    def drive(self) -> Velocity:
        """Drive a circle by effort; return the velocity once it is steady."""
        wheels = self._bench.node.create_publisher(JointState, f"{_ROBOT}/wheel_cmd")
        command = JointState()
        command.name, command.effort = ["left", "right"], [*_CIRCLE]
        for _ in range(_TIMES):
            wheels.publish(command)
            self._bench.wait(self._is_steady, LONGEST / _TIMES / self._bench.rate)
        if not self._samples:
            raise LcmtoolsError("no odometry came from the simulator", "check the program again")
        return self._samples[-1].forward, self._samples[-1].turn_rate

    def _is_steady(self) -> bool:
        if not self._samples or abs(self._samples[-1].forward) < _NEAR / 2:
            return False
        start = self._samples[-1].time - _STEADY
        recent = [sample.turn_rate for sample in self._samples if sample.time > start]
        return max(recent) - min(recent) < _FLAT

    def _is_at_origin(self) -> bool:
        motion = self._bench.recorder.motion
        return bool(motion) and math.hypot(motion[-1].x, motion[-1].y) < _NEAR

    def _settle(self, step: Step, is_settled: Callable[[], bool]) -> None:
        self.desire(step)
        self._bench.wait(lambda: self._samples and is_settled(), LONGEST / 2 / self._bench.rate)

    def _repeat(self) -> None:
        """Publish it several times, and until the first command: the program may start later."""
        self._repeats -= 1
        if self._repeats > 0 or not self._bench.recorder.commands:
            self._publisher.publish(self._desired)


def check_controller(bench: TestBench, command: Sequence[str]) -> Iterator[CheckResult]:
    """Check a controller of the Husky's speed."""
    robot = _Robot(bench)
    bench.recorder.record_command(JointState, Twist)
    bench.start(command)
    robot.desire(REST)
    row = first_command(
        bench,
        f"does it publish on {_ROBOT}/velocity_cmd or wheel_cmd, once it has odometry and a desired"
        " velocity?",
    )
    yield row
    confirmed: set[str] = set()
    is_lost, is_whole = False, not row.is_ok
    for step in STEPS if row.is_ok else ():
        if is_whole or (is_lost and step != _TURN):
            yield CheckResult(step.title, step.wanted, "not measured", is_ok=False, cause=SAME)
            continue
        run, result = _measured(bench, robot, step, confirmed)
        yield result
        is_lost = not result.is_ok and result.cause in _LOST
        is_whole = not result.is_ok and (
            command_cause(run) is not None
            or cause_of(result, bench.observe()).key in (RAISED, IGNORED)
        )


def _measured(
    bench: TestBench, robot: _Robot, step: Step, confirmed: set[str]
) -> tuple[StepRun, CheckResult]:
    """Return a step's run and row. The program may use the real clock.

    The step is first measured faster than real time. A failure counts when a measurement in real
    time has confirmed it, unless these have taken long already. If that succeeds, the check goes on
    in real time.
    """
    program = bench.running()
    robot.prepare(step)
    run = robot.measure(step)
    result = judge(run)
    is_late = confirmed and bench.recorder.duration > _LATE
    is_known = result.is_ok or result.cause in confirmed or is_late
    if not is_known and program.code is None:
        robot.prepare(step)
        if bench.has_slowed_down():
            run = robot.measure(step)
            result = judge(run)
            if not result.is_ok:
                confirmed.add(result.cause)
                bench.speed_up()
    if program.code is not None:
        result = early_end(step.title)
    return run, result


def check_evaluator(bench: TestBench, command: Sequence[str]) -> Iterator[CheckResult]:
    """Check a node that evaluates a controller: with a robot at rest, and with a moving one."""
    stats = bench.recorder.record(ControllerEvaluationStat, f"{_ROBOT}/evaluation_stat")
    robot = _Robot(bench)
    program = bench.start(command)
    robot.desire(_GOAL)
    hint = f"does it read odometry and desired_velocity, and publish {_ROBOT}/evaluation_stat?"
    row = CheckResult("publishes", "messages that come", "they come", is_ok=True, hint=hint)
    row = first(bench, lambda: stats, _SOME_TIME, row)
    if not row.is_ok:
        yield row
        return
    bench.wait(lambda: len(stats) >= _SOME or program.code is not None, _SOME_TIME)
    before, error = len(stats), stats[-1].last_error
    robot.desire(REST)
    bench.wait(lambda: stats[-1].last_error < abs(error) / 100, _REACTION)
    bench.wait(lambda: len(stats) >= 2 * before, _REACTION)
    change = _change(stats, before)
    at_rest = [
        _sample(stat, _GOAL if number < change else REST) for number, stat in enumerate(stats)
    ]
    counted = samples_row([sample.stat for sample in at_rest])
    yield counted
    yield error_row("last_error", at_rest[before - 1 : before])
    for average in average_rows(at_rest, change):
        yield average if counted.is_ok else replace(average, cause="samples")
    yield error_row("last_error at the goal", at_rest[-1:])
    yield _moving_row(bench, robot, stats)


def _sample(stat: ControllerEvaluationStat, desired: Step, actual: Velocity = (0.0, 0.0)) -> Sample:
    return Sample(stat, [((desired.forward, desired.turn_rate), actual)])


def _change(stats: Sequence[ControllerEvaluationStat], before: int) -> int:
    """Return the index of the first sample of a robot that is at its goal, ``before`` or later."""
    errors = [stat.last_error for stat in stats]
    half = (errors[before - 1] + errors[-1]) / 2
    return next((i for i in range(before, len(errors)) if errors[i] <= half), before)


def _moving_row(
    bench: TestBench, robot: _Robot, stats: Sequence[ControllerEvaluationStat]
) -> CheckResult:
    """Return the row for the last error of a robot that drives a circle."""
    robot.desire(_GOAL)
    actual = robot.drive()
    bench.wait(lambda: _sample(stats[-1], _GOAL, actual).is_right, _REACTION)
    last = _sample(stats[-1], _GOAL, actual)
    return error_row("last_error of a moving robot", [last])
