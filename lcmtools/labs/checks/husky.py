"""The Husky lab: the step responses of a controller, and the statistics of an evaluator."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from lcmtools.labs.checks.diagnosis import IGNORED, RAISED, SAME, cause_of, explain_number
from lcmtools.labs.checks.observations import Desire, TrueState
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
_LATE = 10.0  # [s] of a check, after which further causes need not be confirmed in real time
FASTEST, _TURN = Step(1.0, 0.0), Step(0.0, 0.3)
STEPS = (Step(0.1, 0.0), Step(0.5, 0.0), FASTEST, REST, _TURN)
_LOST = ("speed-sign", "measured", "zero", "weak", "unmoved-linear.x", "stop")
"""Causes after which other speeds would show nothing new."""


class _Robot:
    """The Husky, commanded by its desired velocity and observed by odometry."""

    def __init__(self, bench: TestBench) -> None:
        self._bench = bench
        self._publisher = bench.node.create_publisher(Twist, f"{_ROBOT}/desired_velocity")
        self._samples: list[TrueState] = []
        self._first_command, self._start = 0, 0.0
        self._desired = Twist()
        self._repeats = 0
        bench.node.create_subscription(Odometry, f"{_ROBOT}/odometry", self._record_odometry, 1000)
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
        seen.desired.append(Desire(seen.time, step.forward, step.turn_rate))

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

    def _is_at_origin(self) -> bool:
        motion = self._bench.recorder.motion
        return bool(motion) and math.hypot(motion[-1].x, motion[-1].y) < _NEAR

    def _settle(self, step: Step, is_settled: Callable[[], bool]) -> None:
        self.desire(step)
        self._bench.wait(lambda: self._samples and is_settled(), LONGEST / 2 / self._bench.rate)

    def _record_odometry(self, odometry: Odometry) -> None:
        self._samples.append(TrueState.by(odometry))

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
    first = bench.first_command(
        f"does it publish on {_ROBOT}/velocity_cmd or wheel_cmd, once it has odometry and a desired"
        " velocity?"
    )
    yield first
    confirmed: set[str] = set()
    is_lost, is_whole = False, not first.is_ok
    for step in STEPS if first.is_ok else ():
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
    assert bench.program is not None
    robot.prepare(step)
    run = robot.measure(step)
    result = judge(run)
    is_late = confirmed and bench.recorder.duration > _LATE
    is_known = result.is_ok or result.cause in confirmed or is_late
    if not is_known and bench.program.code is None:
        robot.prepare(step)
        if bench.has_slowed_down():
            run = robot.measure(step)
            result = judge(run)
            if not result.is_ok:
                confirmed.add(result.cause)
                bench.speed_up()
    if bench.program.code is not None:
        result = bench.program.early_end(step.title)
    return run, result


def check_evaluator(bench: TestBench, command: Sequence[str]) -> Iterator[CheckResult]:
    """Check a node that evaluates a controller, with a robot at rest."""
    stats = bench.recorder.record(ControllerEvaluationStat, f"{_ROBOT}/evaluation_stat")
    robot = _Robot(bench)
    program = bench.start(command)
    desired = Step(0.3, 0.4)
    error = math.hypot(desired.forward, desired.turn_rate)
    robot.desire(desired)
    hint = f"does it read odometry and desired_velocity, and publish {_ROBOT}/evaluation_stat?"
    row = CheckResult("publishes", "messages that come", "they come", is_ok=True, hint=hint)
    row = bench.first(lambda: stats, _SOME_TIME, row)
    if not row.is_ok:
        yield row
        return
    bench.wait(lambda: len(stats) >= _SOME or program.code is not None, _SOME_TIME)
    first, last = stats[0].samples, stats[-1].samples
    counts = last - first == len(stats) - 1
    yield CheckResult(
        "samples",
        "1 more each time",
        f"{first} to {last} in {len(stats)} messages",
        is_ok=counts,
        hint="count in the odometry callback, and only there: one message for each odometry",
    )
    yield _error_result("last_error", stats[-1].last_error, desired)
    average = _error_result("average_error", stats[-1].average_error, desired, last)
    yield average if counts else replace(average, cause="samples")
    robot.desire(REST)
    bench.wait(lambda: stats[-1].last_error < error / 100, 3.0)
    yield _error_result("last_error at the goal", stats[-1].last_error, REST)
    yield CheckResult(
        "average_error remembers",
        f"between 0 and {error:g}",
        f"{stats[-1].average_error:.3f}",
        is_ok=0.0 < stats[-1].average_error < error,
        hint="it is the average of all samples, not of the last one",
        cause="" if average.is_ok else SAME,
    )


def _error_result(what: str, measured: float, desired: Step, samples: int = 0) -> CheckResult:
    wanted = math.hypot(desired.forward, desired.turn_rate)
    is_ok = math.isclose(measured, wanted, rel_tol=0.02, abs_tol=0.005)
    cause = error_cause(measured, desired, samples)
    hint = error_hint(cause, "the root of the mean of the squares of all errors" if samples else "")
    return CheckResult(what, f"{wanted:.3f}", f"{measured:.3f}", is_ok, hint, cause or what)


def error_hint(cause: str, formula: str = "") -> str:
    """Return a hint: the formula of the error, and the one used in its place if known."""
    formula = formula or "the root of (v - desired v)^2 + (w - desired w)^2"
    return f"it is {cause}, and should be {formula}" if cause else formula


def error_cause(measured: float, desired: Step, samples: int = 0) -> str:
    """Return the formula that gives the measured error of a robot at rest; "" if none does.

    ``samples`` is the number of samples in an average.
    """
    v, w = desired.forward, desired.turn_rate
    error = math.hypot(v, w)
    averages = {
        "the sum, not divided by the samples": samples * error,
        "the root of the sum of the squares, not of their mean": math.sqrt(samples) * error,
        "the last error, divided by the samples": error / max(samples, 1),
    }
    return explain_number(
        measured,
        {
            "always 0": 0.0,
            "the square, without the root": v * v + w * w,
            "the error of linear.x only": v,
            "the error of angular.z only": w,
            "the sum |v - desired v| + |w - desired w|": v + w,
            "the negative error": -error,
            "the negative error of linear.x only": -v,
            "the mean of both errors": (v + w) / 2,
            "the root of the mean of both squares": math.sqrt((v * v + w * w) / 2),
            **(averages if samples else {}),
        },
    )
