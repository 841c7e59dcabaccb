"""Step responses of the Husky's speed: requirements and causes of failure. Pure."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from lcmtools.labs.checks.diagnosis import STOPPED, UNMOVED
from lcmtools.labs.checks.measures import BAND, Response, analyse, is_within
from lcmtools.labs.checks.observations import ReceivedMessage, Touch, TrueState
from lcmtools.labs.checks.results import Cause, CheckResult
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import JointState

LONGEST = 8.0  # simulated time that a step is watched at most [s]
_STEADY = 2.0  # [s] simulated, of a speed that stays
_LOST = 3.0  # [s] simulated: a robot that goes the wrong way is watched no longer
_SLOW = 0.02  # [m/s] or [rad/s]: at rest
_SELDOM = 3.0  # [Hz] of commands, in real time, below which a robot is not controlled
_SIDES = ("left", "right")
_RUN_AWAY = 0.3  # [m/s] of a robot that is to turn on the spot
_SPIN = 0.2  # [rad/s] of a robot that is to drive straight ahead
_WEAK, _SMALLEST, _FULL = 0.05, 1e-6, 0.99  # effort
_LAST = 1.0  # [s] in which a speed is seen to change still
_MEASURED = (
    "the odometry has it as twist.twist.linear.x [m/s], "
    "and the turn rate as twist.twist.angular.z [rad/s]"
)


@dataclass(frozen=True, slots=True)
class Step:
    """A step from rest to a desired velocity: forward [m/s], turn rate [rad/s]; both 0 to stop."""

    forward: float
    turn_rate: float

    @property
    def target(self) -> float:
        """The component that is not 0."""
        return self.forward or self.turn_rate

    @property
    def unit(self) -> str:
        """The target's unit."""
        return "rad/s" if self.turn_rate else "m/s"

    @property
    def title(self) -> str:
        """The step in words."""
        if not self.target:
            return "stop from 1 m/s"
        return f"{'drive' if self.forward else 'turn'} at {self.target:g} {self.unit}"

    @property
    def wanted(self) -> str:
        """The response that the lab asks for."""
        if not self.target:
            return f"0 m/s within {LONGEST:g} s"
        return f"{self.target:g} {self.unit} within {BAND:.0%}"


REST = Step(0.0, 0.0)


@dataclass(frozen=True, slots=True)
class StepRun:
    """The observations after a step of the desired velocity.

    ``pace`` is the simulated seconds per second.
    """

    step: Step
    motion: Sequence[TrueState]
    commands: Sequence[ReceivedMessage]
    touches: Sequence[Touch] = ()
    pace: float = 1.0

    @property
    def duration(self) -> float:
        """Time from the first to the last sample [s]."""
        return self.motion[-1].time - self.motion[0].time if self.motion else 0.0

    def values(self) -> list[tuple[float, float]]:
        """Return pairs of the time since the step [s] and the velocity component of the step."""
        start, turns = self.motion[0].time, self.step.turn_rate
        return [(s.time - start, s.turn_rate if turns else s.forward) for s in self.motion]

    def last_parts(self) -> list[float]:
        """Return the velocities of the last second divided by the target, which is not 0."""
        return [v / self.step.target for time, v in self.values() if time > self.duration - _LAST]

    def response(self) -> Response:
        """Measure the response to a target that is not 0."""
        return analyse(self.values(), self.step.target)

    def is_over(self) -> bool:
        """Return True if further samples would change nothing."""
        if not self.motion:
            return False
        if not self.step.target:
            return is_at_rest(self.motion) or self.duration > LONGEST
        now, response = self.duration, self.response()
        settled = response.settled_after
        is_wrong = now > _LOST and response.reached / self.step.target < -BAND
        is_settled = settled is not None and now - settled > _STEADY
        return now > LONGEST or is_wrong or is_settled or (now > 2 * _STEADY and self._stays())

    def _stays(self) -> bool:
        """Return True if the speed has been steady, and the efforts where the robot stands."""
        start = self.motion[-1].time - _STEADY
        recent = [value for value, sample in zip(self.values(), self.motion, strict=True)
                  if sample.time > start]  # fmt: skip
        speeds = [value for _, value in recent]
        if max(speeds) - min(speeds) > BAND / 5 * abs(self.step.target):
            return False
        if abs(speeds[-1]) > _SLOW:
            return True
        efforts = [tuple(_efforts(command)) for command in self.commands if command.time > start]
        return all(effort == efforts[0] for effort in efforts)


def is_at_rest(motion: Sequence[TrueState]) -> bool:
    """Return True if the robot stands still in the newest sample."""
    return bool(motion) and max(abs(motion[-1].forward), abs(motion[-1].turn_rate)) < _SLOW


def judge(run: StepRun) -> CheckResult:
    """Return the row for a step."""
    step = run.step
    if not run.motion:
        hint = "does the simulator still run?"
        return CheckResult(step.title, step.wanted, "no odometry", is_ok=False, hint=hint)
    if not step.target:
        return _judge_stop(run)
    response = run.response()
    settled = response.settled_after
    after = "never settled" if settled is None else f"settled after {settled:.1f} s"
    measured = f"{response.reached:.3f} {step.unit}, {after}, overshoot {response.overshoot:.0%}"
    is_ok = settled is not None and is_within(response.reached, step.target)
    cause = command_cause(run) or _motion_cause(run, response)
    return CheckResult(step.title, step.wanted, measured, is_ok, cause.text, cause.key)


def _judge_stop(run: StepRun) -> CheckResult:
    is_ok = is_at_rest(run.motion)
    measured = f"at rest after {run.duration:.1f} s" if is_ok else "still moves"
    cause = command_cause(run)
    start, now = abs(run.motion[0].forward), abs(run.motion[-1].forward)
    before = next(
        abs(state.forward) for state in run.motion if state.time > run.motion[-1].time - _LAST
    )
    if cause is None and (now < start / 2 or before - now > BAND / 5 * start):
        cause = Cause(
            "slow", f"too slow, and still changing after {LONGEST:.0f} s: use a greater gain"
        )
    cause = cause or Cause("stop", "a desired velocity of 0 must be followed like any other")
    return CheckResult(REST.title, REST.wanted, measured, is_ok, cause.text, cause.key)


def command_cause(run: StepRun) -> Cause | None:
    """Return the fault in the commands; None if they are right."""
    if not run.commands:
        text = f"no command came in {run.duration:.1f} s: publish one for each odometry message"
        return Cause(STOPPED, text)
    rate = len(run.commands) / max(run.duration, 0.1) * run.pace
    if run.duration > 1.0 and rate < _SELDOM:
        text = f"commands come too seldom, {rate:.2g} a second: publish one for each odometry"
        times = len(run.motion) / run.duration * run.pace
        return Cause("seldom", f"{text} message, which come {times:.0f} times")
    fastest = max((state.forward for state in run.motion), key=abs)
    if run.step.turn_rate and abs(fastest) > _RUN_AWAY:
        text = f"wrong sign of speed (it drives at {fastest:+.2f} m/s, and should not)"
        return Cause("speed-sign", text)
    if run.touches:  # it may have gone there because it drives the wrong way
        stuck = Cause("stuck", f"the robot is stuck on {run.touches[0]}")
        return (run.step.target and _sign_cause(run, run.response())) or stuck
    return _effort_cause([m.message for m in run.commands if isinstance(m.message, JointState)])


def _effort_cause(states: Sequence[JointState]) -> Cause | None:
    """Return the fault in the efforts of the wheels."""
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
    """Return the fault that the motion shows although commands arrive."""
    if wrong_way := _sign_cause(run, response):
        return wrong_way
    step, part = run.step, response.reached / run.step.target
    if step.turn_rate and math.isclose(math.degrees(part), 1.0, rel_tol=0.2):
        text = f"{math.degrees(response.reached):.2f} in degrees: angular.z is in rad/s"
        return Cause("unit", f"it turns at {response.reached:.4f} rad/s, which are {text}")
    last = run.last_parts()
    if min(last) > 1 - BAND or max(last) < 1 + BAND:
        if part < BAND:
            return _unmoved_cause(run)
        if not 1 - BAND <= part <= 1 + BAND:
            return _offset_cause(run, is_slow=part < 1)
    text = "it oscillates around the target: a smaller gain, or smaller steps of the effort"
    return Cause("swings", text)


def _sign_cause(run: StepRun, response: Response) -> Cause | None:
    """Return the cause of driving or turning in the wrong direction."""
    step, part = run.step, response.reached / run.step.target
    spin = run.motion[-1].turn_rate
    is_spinning = bool(step.forward) and abs(spin) > _SPIN
    reached = f"{response.reached:+.2f} {step.unit} instead of {step.target:+g}"
    if (part < -BAND and response.overshoot > BAND) or (is_spinning and part > 1 + BAND):
        return Cause("measured", f"the effort does not follow the measured velocity: {_MEASURED}")
    if part < -BAND and step.forward:
        text = f"wrong sign of speed ({reached}): the error is desired minus measured"
        return Cause("speed-sign", f"{text}, and an effort above 0 drives forward")
    if part < -BAND or is_spinning:
        turned = reached if step.turn_rate else f"it turns at {spin:+.2f} rad/s, and should not"
        text = f"wrong sign of turn ({turned}): the sign, or left and right, are exchanged"
        return Cause("turn-sign", f"{text}; to turn left the right wheels are the faster ones")
    return None


def _offset_cause(run: StepRun, *, is_slow: bool) -> Cause:
    """Return the cause of a steady wrong speed in the right direction."""
    key, way, verdict = ("slow", "grow", "low") if is_slow else ("fast", "shrink", "high")
    efforts = [tuple(round(e, 6) for e in _efforts(command)) for command in run.commands]
    parts = run.last_parts()
    change = parts[-1] - parts[0]
    if len(set(efforts)) <= 2:  # noqa: PLR2004 - that before the step, and that since
        text = f"too {key}: its effort is the same whatever the measured speed is: {_MEASURED}"
    elif not is_slow and max(map(abs, efforts[-1]), default=0.0) > _FULL:
        text = f"too fast: its effort grows although the speed is too high: {_MEASURED}"
    elif abs(change) > BAND / 5 and (change > 0) == is_slow:
        text = f"too {key}, and still changing after {run.duration:.0f} s: use a greater gain"
    else:
        text = f"too {key}: let the effort {way} as long as the speed is too {verdict}"
    return Cause(key, text)


def _unmoved_cause(run: StepRun) -> Cause:
    field = "linear.x" if run.step.forward else "angular.z"
    strongest = max((abs(e) for command in run.commands for e in _efforts(command)), default=0.0)
    if strongest < _SMALLEST:
        text = f"it does not move: its commands are all 0: is {field} of desired_velocity used?"
        return Cause("zero", text)
    if strongest < _WEAK:
        text = f"it does not move: the largest effort is {strongest:.3f}, below the dead band"
        return Cause("weak", text)
    return Cause(f"{UNMOVED}{field}", f"it does not move: does it use {field}?")


def _efforts(command: ReceivedMessage) -> Sequence[float]:
    """Return the efforts or speeds of the two sides, in the command's unit."""
    message = command.message
    if isinstance(message, JointState):
        return [*message.effort, *message.velocity]
    assert isinstance(message, Twist)
    return message.linear.x, message.angular.z
