"""The check of the Pioneer lab's path: the robot's distance from it, and the part driven."""

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import accumulate, pairwise

from lcmtools.labs.checks.diagnosis import SELDOM, STRAYS, velocity_of
from lcmtools.labs.checks.measures import velocity_text
from lcmtools.labs.checks.observations import ReceivedMessage, Touch, TrueState
from lcmtools.labs.checks.program_rows import STOPS, early_end, first_command, stop_at_end
from lcmtools.labs.checks.recorder import LEAST_POSES, PATH
from lcmtools.labs.checks.results import Cause, CheckResult
from lcmtools.labs.checks.steering_formula import ANGLE, steering_cause
from lcmtools.labs.checks.test_bench import TestBench
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Path

_FIRST = 10.0  # [s]
_FARTHEST, _MEAN = 0.25, 0.10  # [m] from the path
_LOST = 1.0  # [m]; farther away, the robot does not follow the path
_PATIENCE, _PROGRESS = 8.0, 0.3  # [s] simulated, and the progress in it [m]
EACH = 0.8  # commands for each pose of the robot
_MOST = 0.95  # of the path: its end may be where a student's robot stops
_AHEAD, _BEHIND = 1.0, 0.3  # [m] along the path in which the robot is searched, from where it was
_STOPPING = 3.0  # [s] simulated, in which a robot stops at the end
_AT_REST = 0.02  # [m], [m/s] or [rad/s]
_SPIN = 4.0  # [rad/s]; to follow the path takes less
_HURRY = 20.0  # [rad/s]; even a controller with a high gain commands less
_FIRST_BEND = 2.0  # [m] along the path; a robot that turns away gets no farther
_BEND = 1.0  # [rad/s]; a bend of the path takes no more for long
_ROUND, _SWING = 1.25 * math.pi, 1.0  # [rad] of a turn the long way round, and of one too fast

Point = tuple[float, float]


@dataclass
class DrivenPath:
    """The drive of a robot along a path."""

    points: Sequence[Point]  # (x, y) of the path, LEAST_POSES or more [m]
    # The distance along the path that the robot has come [m]; it never goes back.
    along: float = 0.0
    # The robot's states, and its distance from the path [m], positive to the left.
    offsets: list[tuple[TrueState, float]] = field(default_factory=list)
    last_progress: float = 0.0  # simulated time of the last progress that counts [s]

    def __post_init__(self) -> None:
        """Measure the path."""
        steps = (math.dist(a, b) for a, b in pairwise(self.points))
        self._starts = [0.0, *accumulate(steps)]
        self.length = self._starts[-1]
        self._progress = 0.0

    def add(self, sample: TrueState) -> None:
        """Add the robot's next state."""
        if not self.offsets:
            self.last_progress = sample.time
        places = [
            self._beside(number, sample)
            for number, (start, end) in enumerate(pairwise(self._starts))
            if self.along - _BEHIND <= end and start <= self.along + _AHEAD
        ]
        offset, along = min(places, key=lambda place: abs(place[0]))
        self.offsets.append((sample, offset))
        self.along = max(self.along, along)
        if self.along > self._progress + _PROGRESS:
            self._progress, self.last_progress = self.along, sample.time

    def is_over(self, now: float) -> bool:
        """Return True at the end of the path, far away from it, or without progress."""
        if not self.offsets:
            return False
        is_lost = abs(self.offsets[-1][1]) > _LOST or now - self.last_progress > _PATIENCE
        return is_lost or self.along > self.length - _AT_REST

    @property
    def farthest(self) -> tuple[TrueState, float]:
        """The state that is farthest from the path, and its offset [m]."""
        return max(self.offsets, key=lambda offset: abs(offset[1]))

    @property
    def mean(self) -> float:
        """The mean distance from the path [m]."""
        return math.fsum(abs(offset) for _, offset in self.offsets) / len(self.offsets)

    def _beside(self, number: int, sample: TrueState) -> tuple[float, float]:
        """The offset from a piece of the path, and the distance along the path there [m]."""
        (x0, y0), (x1, y1) = self.points[number], self.points[number + 1]
        dx, dy, x, y = x1 - x0, y1 - y0, sample.x - x0, sample.y - y0
        square = dx * dx + dy * dy
        part = max(0.0, min(1.0, (x * dx + y * dy) / square)) if square else 0.0
        distance = math.hypot(x - part * dx, y - part * dy)
        left = math.copysign(1.0, dx * y - dy * x)
        return left * distance, self._starts[number] + part * math.sqrt(square)


def check_path(bench: TestBench, command: Sequence[str]) -> Iterator[CheckResult]:
    """Check a program that follows the path of the Pioneer's world."""
    seen = bench.recorder
    paths = seen.record(Path, PATH)
    seen.record_command(Twist)
    bench.wait(lambda: paths, _FIRST)
    if not paths or len(paths[0].poses) < LEAST_POSES:
        measured = f"poses of the one that came: {len(paths[0].poses)}" if paths else "none came"
        hint = "does the simulator still run?"
        yield CheckResult("finds a path", PATH, measured, is_ok=False, hint=hint)
        return
    seen.take(PATH, paths[0], time.monotonic())
    program = bench.start(command)
    first = first_command(bench, "does it publish on /RosAria/cmd_vel?")
    yield first
    if not first.is_ok:
        return
    drive = DrivenPath(seen.path)
    results = _driven(bench, drive)
    is_wrong = not all(result.is_ok for result in results)
    # a program that does not answer each pose may go by the real clock: that is to confirm it
    is_certain = results[0].cause != SELDOM
    if is_wrong and not is_certain and program.code is None and bench.has_slowed_down():
        bench.start_again()
        program, drive = bench.start(command), DrivenPath(seen.path)
        results = _driven(bench, drive)
    has_driven = program.code == 0 and drive.along > _PROGRESS
    if program.code is None or has_driven:
        yield from results
        if has_driven and all(result.is_ok for result in results):
            yield stop_at_end(bench)
    else:
        yield early_end("drives the path")


def _driven(bench: TestBench, drive: DrivenPath) -> list[CheckResult]:
    """Drive from here, and return the rows."""
    program, seen = bench.program, bench.recorder
    first, touch = len(seen.motion), len(seen.touches)
    assert program is not None

    def is_over() -> bool:
        for sample in seen.motion[first + len(drive.offsets) :]:
            drive.add(sample)
        return drive.is_over(bench.time) or program.code is not None

    bench.wait(is_over, 2 * drive.length / _LOST / bench.rate + 60.0)
    touches = seen.touches[touch:]
    rest = [_rest_row(bench)] if drive.offsets else []  # at once: it takes a while to judge a drive
    rows = list(judge(drive, touches, seen.commands))
    if all(row.is_ok for row in rows) and program.code is None:
        return rows + rest
    # commands that come seldom may do so because a callback waits
    is_seldom = len(seen.commands) <= EACH * len(drive.offsets)
    is_unclear = is_seldom and not any(row.cause == ANGLE for row in rows)
    return [replace(row, cause=SELDOM) if is_unclear else row for row in rows]


def _rest_row(bench: TestBench) -> CheckResult:
    """Return the row for a robot that must stop at the end, while its program goes on."""
    motion, program = bench.recorder.motion, bench.program
    assert program is not None

    def is_at_rest() -> bool:
        return max(abs(motion[-1].forward), abs(motion[-1].turn_rate)) < _AT_REST

    start = bench.time
    bench.wait(
        lambda: is_at_rest() or bench.time > start + _STOPPING or program.code is not None,
        _STOPPING / bench.rate + _STOPPING,
    )
    measured = (
        "at rest" if is_at_rest() else velocity_text((motion[-1].forward, motion[-1].turn_rate))
    )
    text = "at the last point publish a Twist of 0, and no other after it"
    cause = Cause("no-stop", f"{text}: the robot keeps its last command")
    wanted = f"at rest within {_STOPPING:g} s"
    return CheckResult(STOPS, wanted, measured, is_at_rest(), cause.text, cause.key)


def judge(
    drive: DrivenPath, touches: Sequence[Touch], commands: Sequence[ReceivedMessage] = ()
) -> Iterator[CheckResult]:
    """Judge a drive: the length, the greatest and the mean distance."""
    wanted = f"{_MOST:.0%} of {drive.length:.1f} m"
    if not drive.offsets:
        yield CheckResult("drives the path", wanted, "no pose came", is_ok=False)
        return
    cause = drive_cause(drive, touches, commands)
    sample, offset = drive.farthest
    side = "left" if offset > 0 else "right"
    for what, limit, measured, is_ok in (
        ("drives the path", wanted, f"{drive.along:.1f} m", drive.along >= _MOST * drive.length),
        (
            "farthest from the path",
            f"{_FARTHEST:g} m at most",
            f"{abs(offset):.2f} m to the {side}, at ({sample.x:.1f}, {sample.y:.1f})",
            abs(offset) <= _FARTHEST,
        ),
        (
            "mean distance from the path",
            f"{_MEAN:g} m at most",
            f"{drive.mean:.3f} m",
            drive.mean <= _MEAN,
        ),
    ):
        yield CheckResult(what, limit, measured, is_ok, cause.text, cause.key)


def drive_cause(
    drive: DrivenPath, touches: Sequence[Touch], commands: Sequence[ReceivedMessage] = ()
) -> Cause:
    """Return the cause of leaving the path, from the robot's motion."""
    last, offset = drive.offsets[-1]
    wrong_angle = steering_cause(drive.points, [state for state, _ in drive.offsets], commands)
    if touches:
        touch = touches[0]
        text = f"the robot touches {touch.body} at ({touch.x:.1f}, {touch.y:.1f})"
        if not wrong_angle:
            return Cause("touch", text)
        return replace(wrong_angle, text=f"{text}: {wrong_angle.text}")
    if wrong_angle:
        return wrong_angle
    if wrong_velocity := _velocity_cause(drive, commands):
        return wrong_velocity
    if abs(offset) <= _LOST and drive.along < _MOST * drive.length:
        does = "turns" if abs(last.turn_rate) > _AT_REST else "stands"
        text = f"it gets no farther than ({last.x:.1f}, {last.y:.1f}), where it {does} at the end"
        return Cause("stops", text)
    return Cause(
        STRAYS,
        "it cuts corners if its target point is far ahead, oscillates if the point is too near or"
        " it turns too fast, and stays beside the path if it uses a pose other than /ground_truth",
    )


def _velocity_cause(drive: DrivenPath, commands: Sequence[ReceivedMessage]) -> Cause | None:
    """Return the cause that the robot's velocities show."""
    first, (_, offset) = drive.offsets[0][0], drive.offsets[-1]
    if max(math.dist((s.x, s.y), (first.x, first.y)) for s, _ in drive.offsets) < _AHEAD / 10:
        return Cause("no-motion", "the robot does not move: linear.x is its speed [m/s]")
    if min(s.forward for s, _ in drive.offsets) < -_AT_REST:
        return Cause("speed-sign", "it drives backward: forward is linear.x above 0")
    wanted = max(
        (abs(v[1]) for command in commands if (v := velocity_of(command.message))), default=0.0
    )
    if wanted > _HURRY:
        return _too_fast(wanted)
    if wrapped := _turn_around([sample for sample, _ in drive.offsets]):
        text = f"it turns all the way round at ({wrapped.x:.1f}, {wrapped.y:.1f}): bring the angle"
        return Cause("wrap", f"{text} between -pi and pi: remainder(angle, 2 * pi)")
    away = [s.turn_rate * side for s, side in drive.offsets if abs(side) > _MEAN]
    is_early = drive.along < (_FIRST_BEND if abs(offset) > _LOST else _LOST)
    if is_early and math.fsum(away) > 0:
        text = "wrong sign of turn: it turns away from the path; left is angular.z above 0"
        return Cause("turn-sign", f"{text}, and /ground_truth is in the path's frame")
    fastest = max(abs(sample.turn_rate) for sample, _ in drive.offsets)
    return _too_fast(fastest) if fastest > _SPIN else None


def _too_fast(turn_rate: float) -> Cause:
    text = f"it turns at {turn_rate:.1f} rad/s: is a gain too high, an angle in degrees, or"
    return Cause("unit", f"{text} orientation.z the heading? That is 2*atan2(z, w) [rad]")


def _turn_around(samples: Sequence[TrueState]) -> TrueState | None:
    """Return the place where a robot turned a full circle after driving well, or None."""
    turned, first = 0.0, samples[0]
    for before, now in pairwise(samples):
        if abs(now.turn_rate) < _BEND or now.turn_rate * before.turn_rate < 0:
            if turned > _SWING:
                return None
            turned, first = 0.0, now
        turned += abs(now.turn_rate) * (now.time - before.time)
        if turned > _ROUND:
            way = math.dist((first.x, first.y), (samples[0].x, samples[0].y))
            return first if way > _LOST else None
    return None
