"""The Husky lab: the step responses of a controller, and the statistics of an evaluator."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from lcmtools.labs.checks.diagnosis import SAME, explain_number, ignored
from lcmtools.labs.checks.measures import BAND, Response, analyse, is_within
from lcmtools.labs.checks.observations import Command, Desire, Sample, Touch
from lcmtools.labs.checks.results import Cause, CheckResult
from lcmtools.labs.checks.test_bench import TestBench
from lcmtools.types.air_lab0 import ControllerEvaluationStat
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import JointState

_ROBOT = "/husky0"
_REPEAT = 0.2  # [s] a desired velocity is repeated: LCM loses messages, and programs start late
_LONGEST, _STEADY = 8.0, 2.0  # [s] simulated
_SLOW = 0.02  # [m/s] or [rad/s]: at rest
_FIRST_MESSAGE = 10.0  # [s]
_SOME = 6  # messages
_LOST = ("speed-sign", "zero", "weak", "unmoved-linear.x", "stop")
"""Causes after which other speeds would show nothing new."""
_LOST_CAUSE = 3.0  # [s] simulated: a robot that goes the wrong way is watched no longer
_SELDOM = 3.0  # [Hz] of commands, in real time, below which a robot is not controlled
_SIDES = ("left", "right")
_RUN_AWAY = 0.3  # [m/s] of a robot that is to turn on the spot
_SPIN = 0.2  # [rad/s] of a robot that is to drive straight ahead
_WEAK, _SMALLEST = 0.05, 1e-6  # effort


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
        if not self.target:
            return "stop from 1 m/s"
        return f"{'drive' if self.forward else 'turn'} at {self.target:g} {self.unit}"


_STEPS = (Step(0.1, 0.0), Step(0.5, 0.0), Step(1.0, 0.0))
_TURN = Step(0.0, 0.3)
_REST = Step(0.0, 0.0)


@dataclass(frozen=True, slots=True)
class StepRun:
    """The observations after a step of the desired velocity.

    ``pace`` is that of the simulation: simulated seconds per second.
    """

    step: Step
    motion: Sequence[Sample]
    commands: Sequence[Command]
    touches: Sequence[Touch] = ()
    pace: float = 1.0

    def values(self) -> list[tuple[float, float]]:
        """Return the time since the step [s], and the velocity of the step's kind."""
        start = self.motion[0].time
        forward = bool(self.step.forward)
        return [(s.time - start, s.forward if forward else s.turn_rate) for s in self.motion]


class _Robot:
    """The Husky, commanded by its desired velocity and observed by odometry."""

    def __init__(self, bench: TestBench) -> None:
        self._bench = bench
        self._publisher = bench.node.create_publisher(Twist, f"{_ROBOT}/desired_velocity")
        self._samples: list[Sample] = []
        self._start = 0.0
        self._desired = Twist()
        bench.subscribe(Odometry, f"{_ROBOT}/odometry", self._take_odometry)
        bench.node.create_timer(_REPEAT, self._publish)

    def desire(self, step: Step) -> None:
        """Publish a desired velocity, and forget what was measured before."""
        self._desired.linear.x, self._desired.angular.z = step.forward, step.turn_rate
        self._publish()
        self._samples.clear()
        self._start = self._bench.time
        self._bench.desired.append(Desire(self._start, step.forward, step.turn_rate))

    def run(self, step: Step) -> StepRun:
        """Return what was observed since the velocity was desired."""
        commands = [one for one in self._bench.commands if one.time > self._start]
        touches = [one for one in self._bench.touches if one.time > self._start]
        return StepRun(step, self._samples, commands, touches, self._bench.rate)

    def is_at_rest(self) -> bool:
        """Return True if the newest odometry is of a robot that does not move."""
        newest = self._samples[-1] if self._samples else None
        return newest is not None and max(abs(newest.forward), abs(newest.turn_rate)) < _SLOW

    def _take_odometry(self, odometry: Odometry) -> None:
        stamp, twist = odometry.header.stamp, odometry.twist.twist
        place = odometry.pose.pose.position
        time = stamp.sec + stamp.nsec / 1e9
        self._samples.append(Sample(time, place.x, place.y, twist.linear.x, twist.angular.z))

    def _publish(self) -> None:
        self._publisher.publish(self._desired)


def check_controller(bench: TestBench, command: Sequence[str]) -> Iterator[CheckResult]:
    """Check a controller of the Husky's speed."""
    robot = _Robot(bench)
    bench.record_command((JointState, Twist))
    program = bench.start(command)
    robot.desire(_REST)
    bench.wait(lambda: bench.commands or program.code is not None, _FIRST_MESSAGE)
    what, wanted = "commands the robot", "messages that come"
    if not bench.commands:
        hint = (
            f"does it publish on {_ROBOT}/velocity_cmd or wheel_cmd, once it has odometry and a"
            " desired velocity?"
        )
        yield program.nothing_within(_FIRST_MESSAGE, what, wanted, hint)
        return
    yield CheckResult(what, wanted, "they come", is_ok=True)
    is_lost = is_whole = False
    for step in (*_STEPS, _REST, _TURN):
        if is_whole or (is_lost and step != _TURN):
            yield CheckResult(step.title, _wanted(step), "not measured", is_ok=False, cause=SAME)
            continue
        result = _stop(bench, robot) if step == _REST else _drive(bench, robot, step)
        yield result
        run = robot.run(step)
        is_whole = not (result.is_ok or (run.motion and not _command_cause(run) and _obeyed(bench)))
        is_lost = not result.is_ok and result.cause in _LOST
    yield program.check_ctrl_c()


def _obeyed(bench: TestBench) -> bool:
    return ignored(bench.observe()) is None


def _wanted(step: Step) -> str:
    if step == _REST:
        return f"0 m/s within {_LONGEST:g} s"
    return f"{step.target:g} {step.unit} within {BAND:.0%}"


def _drive(bench: TestBench, robot: _Robot, step: Step) -> CheckResult:
    assert bench.program is not None
    if bench.program.code is not None:
        return bench.program.early_end(step.title)
    robot.desire(_REST)
    bench.wait(robot.is_at_rest, _LONGEST / 2 / bench.rate)
    bench.reset_pose(_ROBOT)
    robot.desire(step)

    def is_over() -> bool:
        run = robot.run(step)
        if not run.motion:
            return False
        response = analyse(run.values(), step.target)
        settled, now = response.settled_after, run.values()[-1][0]
        is_wrong = now > _LOST_CAUSE and response.reached / step.target < -BAND
        is_over = now > _LONGEST or is_wrong or _stays(run.values(), now, step.target)
        return is_over or (settled is not None and now - settled > _STEADY)

    bench.wait(is_over, 2 * _LONGEST / bench.rate + 5.0)
    run = robot.run(step)
    if bench.program.code is not None:
        return bench.program.early_end(step.title)
    if not run.motion:
        hint = "does the simulator still run?"
        return CheckResult(step.title, _wanted(step), "no odometry", is_ok=False, hint=hint)
    response = analyse(run.values(), step.target)
    settled = response.settled_after
    after = "never settled" if settled is None else f"settled after {settled:.1f} s"
    measured = f"{response.reached:.3f} {step.unit}, {after}, overshoot {response.overshoot:.0%}"
    is_ok = settled is not None and is_within(response.reached, step.target)
    cause = step_cause(run, response)
    return CheckResult(step.title, _wanted(step), measured, is_ok, cause.text, cause.key)


def _stays(values: Sequence[tuple[float, float]], now: float, target: float) -> bool:
    """Return True if a robot that moves has kept a wrong speed for some time."""
    last = [value for time, value in values if time > now - _STEADY]
    is_steady = max(last) - min(last) < BAND / 5 * abs(target)
    return now > 2 * _STEADY and is_steady and abs(last[-1]) > _SLOW


def step_cause(run: StepRun, response: Response) -> Cause:
    """Return why a step of the desired velocity was not followed."""
    return _command_cause(run) or _motion_cause(run, response)


def _command_cause(run: StepRun) -> Cause | None:
    """Return the fault of the commands themselves."""
    duration = run.motion[-1].time - run.motion[0].time
    if not run.commands:
        text = f"no command came in {duration:.1f} s: publish one for each odometry message"
        return Cause("stopped", text)
    rate = len(run.commands) / max(duration, 0.1) * run.pace
    if duration > 1.0 and rate < _SELDOM:
        text = f"commands come too seldom, {rate:.2g} a second: publish one for each odometry"
        times = len(run.motion) / duration * run.pace
        return Cause("seldom", f"{text} message, which come {times:.0f} times")
    fastest = max((one.forward for one in run.motion), key=abs)
    if run.step.turn_rate and abs(fastest) > _RUN_AWAY:
        text = f"wrong sign of speed (it drives at {fastest:+.2f} m/s, and should not)"
        return Cause("speed-sign", text)
    if run.touches:
        return Cause("stuck", f"the robot is stuck on {run.touches[0]}")
    return _effort_cause([m.message for m in run.commands if isinstance(m.message, JointState)])


def _effort_cause(states: Sequence[JointState]) -> Cause | None:
    """Return what is missing in the commands of the wheels."""
    if states and not any(state.effort for state in states):
        field = "velocity" if any(state.velocity for state in states) else "position"
        text = f"its commands are in {field}, and the wheels are driven by effort, from -1 to 1"
        return Cause("field", text)
    sides = [tuple(state.effort) for state in states if len(state.effort) == len(_SIDES)]
    moving = [any(efforts) for efforts in zip(*sides, strict=True)]
    if any(moving) and not all(moving):
        still = _SIDES[moving.index(False)]
        return Cause("one-side", f"the effort of the {still} wheels is always 0: set both sides")
    return None


def _motion_cause(run: StepRun, response: Response) -> Cause:
    """Return the fault that the motion shows, while commands come as they should."""
    step, part = run.step, response.reached / run.step.target
    spin = run.motion[-1].turn_rate
    reached = f"{response.reached:+.2f} {step.unit} in place of {step.target:+g}"
    if part < -BAND and step.forward:
        text = f"wrong sign of speed ({reached}): the error is desired minus measured"
        return Cause("speed-sign", f"{text}, and an effort above 0 drives forward")
    if part < -BAND or (step.forward and abs(spin) > _SPIN):
        turned = reached if step.turn_rate else f"it turns at {spin:+.2f} rad/s, and should not"
        text = f"wrong sign of turn ({turned}): the sign, or left and right, are exchanged"
        return Cause("turn-sign", f"{text}; to turn left the right wheels are the faster ones")
    if part < BAND:
        return _unmoved_cause(run)
    if part < 1 - BAND:
        return Cause("slow", "too slow: let the effort grow as long as the speed is too low")
    if part > 1 + BAND:
        return Cause("fast", "too fast: let the effort shrink as long as the speed is too high")
    text = "it swings around the target: a smaller gain, or smaller steps of the effort"
    return Cause("swings", text)


def _unmoved_cause(run: StepRun) -> Cause:
    field = "linear.x" if run.step.forward else "angular.z"
    strongest = max((abs(e) for one in run.commands for e in _efforts(one)), default=0.0)
    if strongest < _SMALLEST:
        text = "it does not move: its commands are all 0: is desired_velocity kept and used?"
        return Cause("zero", text)
    if strongest < _WEAK:
        text = f"it does not move: the largest effort is {strongest:.3f}, below the dead band"
        return Cause("weak", text)
    return Cause(f"unmoved-{field}", f"it does not move: does it use {field}?")


def _efforts(command: Command) -> Sequence[float]:
    """Return what a command makes of the two sides, in its own unit."""
    message = command.message
    if isinstance(message, JointState):
        return [*message.effort, *message.velocity]
    assert isinstance(message, Twist)
    return message.linear.x, message.angular.z


def _stop(bench: TestBench, robot: _Robot) -> CheckResult:
    assert bench.program is not None
    if bench.program.code is not None:
        return bench.program.early_end(_REST.title)
    robot.desire(_REST)
    start = bench.time
    stopped = bench.wait(robot.is_at_rest, _LONGEST / bench.rate + 1.0)
    seconds = bench.time - start
    run = robot.run(_REST)
    cause = run.motion and _command_cause(run)
    cause = cause or Cause("stop", "a desired velocity of 0 is one like any other")
    return CheckResult(
        _REST.title,
        _wanted(_REST),
        f"at rest after {seconds:.1f} s" if stopped else "still moves",
        is_ok=stopped and seconds <= _LONGEST,
        hint=cause.text,
        cause=cause.key,
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
        hint = f"does it read odometry and desired_velocity, and publish {_ROBOT}/evaluation_stat?"
        yield program.nothing_within(_FIRST_MESSAGE, "publishes", "messages that come", hint)
        return
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
    average = _error_result("average_error", stats[-1].average_error, desired)
    yield average if counts else replace(average, cause="samples")
    robot.desire(_REST)
    bench.wait(lambda: stats[-1].last_error < error / 100, 3.0)
    yield _error_result("last_error at the goal", stats[-1].last_error, _REST)
    yield CheckResult(
        "average_error remembers",
        f"between 0 and {error:g}",
        f"{stats[-1].average_error:.3f}",
        is_ok=0.0 < stats[-1].average_error < error,
        hint="it is the average of all samples, not of the last one",
    )
    yield program.check_ctrl_c()


def _error_result(what: str, measured: float, desired: Step) -> CheckResult:
    wanted = math.hypot(desired.forward, desired.turn_rate)
    is_ok = math.isclose(measured, wanted, rel_tol=0.02, abs_tol=0.005)
    formula = "the root of (v - desired v)^2 + (w - desired w)^2"
    cause = error_cause(measured, desired)
    hint = f"it is {cause}, and should be {formula}" if cause else formula
    return CheckResult(what, f"{wanted:.3f}", f"{measured:.3f}", is_ok, hint, cause or what)


def error_cause(measured: float, desired: Step) -> str:
    """Return the formula that gives the error measured of a robot at rest; "" if none does."""
    v, w = desired.forward, desired.turn_rate
    return explain_number(
        measured,
        {
            "always 0": 0.0,
            "the square, without the root": v * v + w * w,
            "the error of linear.x only": v,
            "the error of angular.z only": w,
            "the sum |v - desired v| + |w - desired w|": v + w,
            "the negative error": -math.hypot(v, w),
            "the negative error of linear.x only": -v,
            "the mean of both errors": (v + w) / 2,
            "the root of the mean of both squares": math.sqrt((v * v + w * w) / 2),
        },
    )
