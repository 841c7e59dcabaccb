"""The Husky lab: does a controller make the robot drive as it should, and is its error known."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from lcmtools.labs.checks.measures import BAND, Response, analyse, is_within
from lcmtools.labs.checks.programs import CheckedProgram
from lcmtools.labs.checks.row import Row, ends_on_ctrl_c, fate, row
from lcmtools.labs.checks.stage import Stage
from lcmtools.messages.registry import Message
from lcmtools.types.air_lab0 import ControllerEvaluationStat
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import JointState

_ROBOT = "/husky0"
_COMMANDS = ("wheel_cmd", "velocity_cmd", "wheel_velocity_cmd")
_REPEAT = 0.2  # [s] a desired velocity is said again: LCM loses messages, and programs start late
_LONGEST, _STEADY = 8.0, 2.0  # [s] simulated
_SLOW = 0.02  # [m/s] or [rad/s]: as good as standing
_FIRST_COMMAND = 10.0  # [s]


@dataclass(frozen=True, slots=True)
class Step:
    """A desired velocity, from rest.

    Attributes:
        forward: [m/s]
        turn_rate: [rad/s]
    """

    forward: float
    turn_rate: float

    @property
    def target(self) -> float:
        """The one of both that is not 0."""
        return self.forward or self.turn_rate

    @property
    def unit(self) -> str:
        """Of the target."""
        return "m/s" if self.forward else "rad/s"


STEPS = (Step(0.1, 0.0), Step(0.5, 0.0), Step(1.0, 0.0), Step(0.0, 0.3))
_STILL = Step(0.0, 0.0)


class _Robot:
    """The Husky as seen from outside: commanded by its desired velocity, watched by odometry."""

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self._desired = stage.node.create_publisher(Twist, f"{_ROBOT}/desired_velocity")
        self._samples: list[tuple[float, float, float]] = []
        self.commands = 0
        self._said = Twist()
        stage.listen(Odometry, f"{_ROBOT}/odometry", self._take)
        for name in _COMMANDS:
            stage.listen((JointState, Twist), f"{_ROBOT}/{name}", self._count)
        stage.listen(Twist, f"{_ROBOT}/cmd_vel", self._count)
        stage.node.create_timer(_REPEAT, self._say)

    def desire(self, step: Step) -> None:
        """Say what velocity is desired, and forget what was measured before."""
        self._said.linear.x, self._said.angular.z = step.forward, step.turn_rate
        self._say()
        self._samples.clear()

    def samples(self, step: Step) -> list[tuple[float, float]]:
        """Time since the first sample [s], and the velocity that the step is about."""
        if not self._samples:
            return []
        start = self._samples[0][0]
        return [
            (time - start, forward if step.forward else turn_rate)
            for time, forward, turn_rate in self._samples
        ]

    def stands(self) -> bool:
        """Return whether it does."""
        return bool(self._samples) and max(map(abs, self._samples[-1][1:])) < _SLOW

    def _take(self, odometry: Odometry) -> None:
        stamp, twist = odometry.header.stamp, odometry.twist.twist
        self._samples.append((stamp.sec + stamp.nsec / 1e9, twist.linear.x, twist.angular.z))

    def _count(self, _command: Message) -> None:
        self.commands += 1

    def _say(self) -> None:
        self._desired.publish(self._said)


def check_controller(stage: Stage, command: Sequence[str]) -> Iterator[Row]:
    """Rows about a controller of the Husky's speed."""
    robot = _Robot(stage)
    program = stage.start(command)
    robot.desire(_STILL)
    stage.wait(lambda: robot.commands or program.code is not None, _FIRST_COMMAND)
    yield _commands_row(robot, program)
    if not robot.commands:
        return
    for step in STEPS:
        if program.code is not None:
            yield fate(f"drive at {step.target:g} {step.unit}", program)
            return
        yield _drive(stage, robot, step)
        yield from _stop(stage, robot) if step == STEPS[-2] else ()
    yield ends_on_ctrl_c(program)


def _commands_row(robot: _Robot, program: CheckedProgram) -> Row:
    what, wanted = "commands the robot", "messages that come"
    if program.code is not None and not robot.commands:
        return fate(what, program, wanted)
    return row(
        what,
        wanted,
        "they come" if robot.commands else f"none within {_FIRST_COMMAND:g} s",
        is_ok=bool(robot.commands),
        hint=f"does it publish on {_ROBOT}/velocity_cmd or wheel_cmd, once it has odometry and a"
        " desired velocity? lcmtools wtf beside it says what is not connected",
    )


def _drive(stage: Stage, robot: _Robot, step: Step) -> Row:
    robot.desire(_STILL)
    stage.wait(robot.stands, _LONGEST / stage.rate)
    stage.put(_ROBOT)
    robot.desire(step)

    def is_over() -> bool:
        samples = robot.samples(step)
        if not samples:
            return False
        settled = analyse(samples, step.target).settled_after
        now = samples[-1][0]
        return now > _LONGEST or (settled is not None and now - settled > _STEADY)

    stage.wait(is_over, 2 * _LONGEST / stage.rate + 5.0)
    samples = robot.samples(step)
    what = f"drive at {step.target:g} {step.unit}" if step.forward else "turn at 0.3 rad/s"
    wanted = f"{step.target:g} {step.unit} within {BAND:.0%}"
    if not samples:
        return Row(what, wanted, "no odometry", is_ok=False, hint="does the simulator still run?")
    response = analyse(samples, step.target)
    is_ok = response.settled_after is not None and is_within(response.reached, step.target)
    return row(what, wanted, _tell(response, step), is_ok=is_ok, hint=_advice(response, step))


def _tell(response: Response, step: Step) -> str:
    settled = response.settled_after
    after = "never settled" if settled is None else f"settled after {settled:.1f} s"
    return f"{response.reached:.3f} {step.unit}, {after}, overshoot {response.overshoot:.0%}"


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


def _stop(stage: Stage, robot: _Robot) -> Iterator[Row]:
    robot.desire(_STILL)
    began = stage.time
    stands = stage.wait(robot.stands, 2 * _LONGEST / stage.rate + 2.0)
    yield row(
        "stop from 1 m/s",
        f"0 m/s within {_LONGEST:g} s",
        f"stands after {stage.time - began:.1f} s" if stands else "still moves",
        is_ok=stands and stage.time - began <= _LONGEST,
        hint="a desired velocity of 0 is one like any other",
    )


def check_evaluator(stage: Stage, command: Sequence[str]) -> Iterator[Row]:
    """Rows about a node that evaluates a controller: of a robot that stands still."""
    heard: list[ControllerEvaluationStat] = []
    stage.listen(ControllerEvaluationStat, f"{_ROBOT}/evaluation_stat", heard.append)
    robot = _Robot(stage)
    program = stage.start(command)
    desired = Step(0.3, 0.4)
    error = math.hypot(desired.forward, desired.turn_rate)
    robot.desire(desired)
    stage.wait(lambda: len(heard) > 5 or program.code is not None, _FIRST_COMMAND)  # noqa: PLR2004 - some
    if not heard:
        yield _silent(program)
        return
    last = heard[-1]
    counts = [stat.samples for stat in heard]
    yield row(
        "samples",
        "1 more each time",
        f"{counts[0]} to {counts[-1]} in {len(counts)} messages",
        is_ok=counts[-1] - counts[0] == len(counts) - 1,
        hint="count in the odometry callback, and only there: one message for each odometry",
    )
    yield _error_row("last_error", last.last_error, error)
    yield _error_row("average_error", last.average_error, error)
    robot.desire(_STILL)
    stage.wait(lambda: heard[-1].last_error < error / 100, 3.0)
    yield _error_row("last_error at the goal", heard[-1].last_error, 0.0)
    yield row(
        "average_error remembers",
        f"between 0 and {error:g}",
        f"{heard[-1].average_error:.3f}",
        is_ok=0.0 < heard[-1].average_error < error,
        hint="it is the average of all samples, not of the last one",
    )
    yield ends_on_ctrl_c(program)


def _silent(program: CheckedProgram) -> Row:
    what, wanted = "publishes", "messages that come"
    if program.code is not None:
        return fate(what, program, wanted)
    hint = (
        f"does it read odometry and desired_velocity, and publish {_ROBOT}/evaluation_stat?"
        " lcmtools node info shows its names"
    )
    return Row(what, wanted, f"none within {_FIRST_COMMAND:g} s", is_ok=False, hint=hint)


def _error_row(what: str, measured: float, wanted: float) -> Row:
    return row(
        what,
        f"{wanted:.3f}",
        f"{measured:.3f}",
        is_ok=math.isclose(measured, wanted, rel_tol=0.02, abs_tol=0.005),
        hint="the root of (v - desired v)^2 + (w - desired w)^2",
    )
