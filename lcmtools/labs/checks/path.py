"""The Pioneer lab's path: how far a robot strays from it, and whether it drives all of it."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import accumulate, pairwise

from lcmtools.labs.checks.observations import Sample, Touch
from lcmtools.labs.checks.results import Cause, CheckResult
from lcmtools.labs.checks.test_bench import TestBench
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Path

_PATH, _VELOCITY = "/path", "/RosAria/cmd_vel"
_FIRST = 10.0  # [s]
_FARTHEST, _MEAN = 0.25, 0.10  # [m] from the path
_LOST = 1.0  # [m]; farther away, the robot does not follow the path
_PATIENCE = 8.0  # [s] simulated, without progress
_MOST = 0.95  # of the path: its end may be where a student's robot stops
_AHEAD, _BEHIND = 1.0, 0.3  # [m] along the path in which the robot is searched, from where it was
_AT_REST = 0.02  # [m]

Point = tuple[float, float]


@dataclass
class Drive:
    """A robot's way along a path.

    Attributes:
        points: (x, y) of the path [m].
        along: The distance along the path that the robot has come [m]; it never goes back.
        offsets: The robot's states, and its distance from the path [m], positive to the left.
        last_progress: Simulated time of the last progress [s].
    """

    points: Sequence[Point]
    along: float = 0.0
    offsets: list[tuple[Sample, float]] = field(default_factory=list)
    last_progress: float = 0.0

    def __post_init__(self) -> None:
        """Measure the path."""
        steps = (math.dist(a, b) for a, b in pairwise(self.points))
        self._starts = [0.0, *accumulate(steps)]
        self.length = self._starts[-1]

    def add(self, sample: Sample) -> None:
        """Take the robot's next state."""
        if not self.offsets:
            self.last_progress = sample.time
        places = [
            self._beside(number, sample)
            for number, start in enumerate(self._starts[:-1])
            if self.along - _BEHIND <= start <= self.along + _AHEAD
        ]
        offset, along = min(places, key=lambda place: abs(place[0]))
        self.offsets.append((sample, offset))
        if along > self.along:
            self.along, self.last_progress = along, sample.time

    def is_over(self, now: float) -> bool:
        """Return True at the path's end, far away from the path, or without progress."""
        if not self.offsets:
            return False
        lost = abs(self.offsets[-1][1]) > _LOST or now - self.last_progress > _PATIENCE
        return lost or self.along > self.length - _AT_REST

    @property
    def farthest(self) -> tuple[Sample, float]:
        """The state that is farthest from the path, and its offset [m]."""
        return max(self.offsets, key=lambda one: abs(one[1]))

    @property
    def mean(self) -> float:
        """The mean distance from the path [m]."""
        return math.fsum(abs(offset) for _, offset in self.offsets) / len(self.offsets)

    def _beside(self, number: int, sample: Sample) -> tuple[float, float]:
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
    paths = bench.record(Path, _PATH)
    commands = bench.record(Twist, _VELOCITY)
    bench.record_command(Twist)
    bench.wait(lambda: paths, _FIRST)
    what, wanted = "commands the robot", "messages that come"
    if not paths:
        hint = "does the simulator still run?"
        yield CheckResult(what, wanted, f"no path came on {_PATH}", is_ok=False, hint=hint)
        return
    bench.path = [(one.pose.position.x, one.pose.position.y) for one in paths[0].poses]
    drive = Drive(bench.path)
    program = bench.start(command)
    bench.wait(lambda: commands or program.code is not None, _FIRST)
    if not commands:
        hint = f"does it publish on {_VELOCITY}?"
        yield program.nothing_within(_FIRST, what, wanted, hint)
        return
    yield CheckResult(what, wanted, "they come", is_ok=True)
    seen, begin = len(bench.motion), bench.time

    def is_over() -> bool:
        nonlocal seen
        for sample in bench.motion[seen:]:
            drive.add(sample)
        seen = len(bench.motion)
        return drive.is_over(bench.time) or program.code is not None

    bench.wait(is_over, 2 * drive.length / _LOST / bench.rate + 60.0)
    touches = [touch for touch in bench.touches if touch.time >= begin]
    yield from judge(drive, touches)
    yield program.check_ctrl_c()


def judge(drive: Drive, touches: Sequence[Touch]) -> Iterator[CheckResult]:
    """Judge a drive: the length, the greatest and the mean distance."""
    wanted = f"{_MOST:.0%} of {drive.length:.1f} m"
    if not drive.offsets:
        yield CheckResult("drives the path", wanted, "no pose came", is_ok=False)
        return
    cause = drive_cause(drive, touches)
    sample, offset = drive.farthest
    side = "left" if offset > 0 else "right"
    for what, limit, measured, is_ok in (
        (
            "drives the path",
            wanted,
            f"{drive.along:.1f} m",
            drive.along >= _MOST * drive.length,
        ),
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


def drive_cause(drive: Drive, touches: Sequence[Touch]) -> Cause:
    """Return why a robot does not follow the path, by where it went."""
    first, (last, offset) = drive.offsets[0][0], drive.offsets[-1]
    if touches:
        touch = touches[0]
        return Cause("touch", f"the robot touches {touch.body} at ({touch.x:.1f}, {touch.y:.1f})")
    if max(math.dist((s.x, s.y), (first.x, first.y)) for s, _ in drive.offsets) < _AHEAD / 10:
        return Cause("no-motion", "the robot does not move: linear.x is its speed [m/s]")
    if min(s.forward for s, _ in drive.offsets) < -_AT_REST:
        return Cause("speed-sign", "it drives backward: forward is linear.x above 0")
    away = [s.turn_rate * side for s, side in drive.offsets if abs(side) > _MEAN]
    if abs(offset) > _LOST and math.fsum(away) > 0:
        text = "wrong sign of turn: it turns away from the path; left is angular.z above 0"
        return Cause("turn-sign", text)
    if abs(offset) <= _LOST and drive.along < _MOST * drive.length:
        return Cause("stops", f"it comes no farther than ({last.x:.1f}, {last.y:.1f})")
    return Cause(
        "strays",
        "it cuts corners if the point that it drives to is far ahead, and swings around the path if"
        " it is too near, or if it turns too fast",
    )
