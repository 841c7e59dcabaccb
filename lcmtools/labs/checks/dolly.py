"""The Dolly lab: a timer that drives a circle, and the ranges of a laser."""

import math
import re
import statistics
import time
from collections.abc import Iterator, Sequence
from itertools import pairwise

from lcmtools.labs.checks.measures import BAND, fit_radius, is_within
from lcmtools.labs.checks.programs import CheckedProgram, CheckResult
from lcmtools.labs.checks.test_bench import TestBench
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import LaserScan

_FORWARD, _TURN_RATE, _RATE = 0.5, 0.3, 2.0  # [m/s], [rad/s], [Hz]: as the lab specifies
_RADIUS = _FORWARD / _TURN_RATE
_VELOCITY, _TRUTH, _SCAN = "/dolly/cmd_vel", "/dolly/ground_truth", "/dolly/laser_scan"
_FIRST, _SOME = 10.0, 8  # [s], commands
_ROUND = 2 * math.pi / _TURN_RATE  # [s] simulated
_NUMBER = re.compile(r"(?<![\w.])\d+\.(\d+)(?![\w.])")
_MOMENT = 0.5  # [s]
_NOISE = 0.03  # [m]
_HINT = "does it {}? lcmtools wtf beside it shows if it is connected"


def check_mover(bench: TestBench, command: Sequence[str]) -> Iterator[CheckResult]:
    """Check a program that drives the Dolly in a circle."""
    times: list[float] = []
    bench.subscribe(Twist, _VELOCITY, lambda _: times.append(time.monotonic()))
    commands = bench.record(Twist, _VELOCITY)
    path = bench.record(Odometry, _TRUTH)
    program = bench.start(command)
    bench.wait(lambda: commands or program.code is not None, _FIRST)
    if not commands:
        hint = _HINT.format(f"publish on {_VELOCITY}")
        yield program.nothing_within(_FIRST, "commands the robot", "messages that come", hint)
        return
    bench.wait(lambda: len(times) >= _SOME, _SOME / _RATE * 2)
    yield _rate(times)
    yield _velocity(commands[-1])
    path.clear()
    start = bench.time
    bench.wait(lambda: bench.time - start > _ROUND or program.code is not None, 3 * _ROUND)
    yield _circle(path)
    yield program.check_ctrl_c()


def _rate(times: Sequence[float]) -> CheckResult:
    gaps = [after - before for before, after in pairwise(times)]
    rate = 1 / statistics.fmean(gaps) if gaps else 0.0
    return CheckResult(
        "rate of commands",
        f"{_RATE:g} Hz within {BAND:.0%}",
        f"{rate:.2f} Hz",
        is_ok=is_within(rate, _RATE),
        hint="a timer of 0.5 s that publishes once each time",
    )


def _velocity(twist: Twist) -> CheckResult:
    forward, turn_rate = twist.linear.x, twist.angular.z
    return CheckResult(
        "velocity commanded",
        f"{_FORWARD:g} m/s, {_TURN_RATE:g} rad/s",
        f"{forward:g} m/s, {turn_rate:g} rad/s",
        is_ok=math.isclose(forward, _FORWARD) and math.isclose(turn_rate, _TURN_RATE),
        hint="linear.x and angular.z; everything else stays 0",
    )


def _circle(path: Sequence[Odometry]) -> CheckResult:
    places = [odometry.pose.pose.position for odometry in path]
    radius = fit_radius([(place.x, place.y) for place in places])
    return CheckResult(
        "circle that it drives",
        f"{_RADIUS:.3f} m within {BAND:.0%}",
        "none" if radius is None else f"{radius:.3f} m",
        is_ok=radius is not None and is_within(radius, _RADIUS),
        hint="its radius is speed / turn rate; a command must come before the last one is too old",
    )


def check_reader(bench: TestBench, command: Sequence[str]) -> Iterator[CheckResult]:
    """Check a program that prints what the laser measures, with a robot at rest."""
    scans = bench.record(LaserScan, _SCAN)
    program = bench.start(command)
    bench.wait(lambda: _lines(program) > 1 or program.code is not None, _FIRST)
    bench.wait(lambda: program.code is not None, _MOMENT)  # several lines may be a crash
    what, wanted = "prints ranges", "ranges of the scan"
    if not _lines(program) or program.code is not None:
        hint = _HINT.format(f"print the messages on {_SCAN}")
        yield program.nothing_within(_FIRST, what, wanted, hint)
        return
    if not bench.wait(lambda: scans, 2.0):
        hint = "does the simulator still run?"
        yield CheckResult(what, wanted, "no scan came", is_ok=False, hint=hint)
        return
    found = ranges_in(program.printed(), scans[-1].ranges)
    yield CheckResult(
        what,
        wanted,
        f"{', '.join(found[:3])} m" if found else f"none; its last line: {program.last_line()}",
        is_ok=bool(found) and _lines(program) > 1,
        hint="print some of scan.ranges with two decimals, again and again",
    )
    yield program.check_ctrl_c()


def ranges_in(text: str, ranges: Sequence[float]) -> list[str]:
    """Return the numbers in a text that are ranges of a scan [m], but for rounding and noise."""
    measured = [value for value in ranges if math.isfinite(value)]
    found = {
        match[0]
        for match in _NUMBER.finditer(text)
        if any(abs(float(match[0]) - value) <= _tolerance(match[1]) for value in measured)
    }
    return sorted(found, key=float)


def _tolerance(decimals: str) -> float:
    return float(0.5 * 10.0 ** -len(decimals)) + _NOISE


def _lines(program: CheckedProgram) -> int:
    return sum(bool(line.strip()) for line in program.printed().splitlines())
