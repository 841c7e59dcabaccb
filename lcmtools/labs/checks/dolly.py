"""The Dolly lab: does a timer drive the circle, and are the laser's ranges read."""

import math
import re
import statistics
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from lcmtools.labs.checks.measures import BAND, fit_radius, is_within
from lcmtools.labs.checks.programs import CheckedProgram
from lcmtools.labs.checks.row import Row, ends_on_ctrl_c, fate, row
from lcmtools.labs.checks.stage import Stage
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import LaserScan

FORWARD, TURN_RATE, RATE = 0.5, 0.3, 2.0
"""[m/s], [rad/s], [Hz]: what the lab asks for."""
RADIUS = FORWARD / TURN_RATE
_VELOCITY, _TRUTH, _SCAN = "/dolly/cmd_vel", "/dolly/ground_truth", "/dolly/laser_scan"
_FIRST, _SOME = 10.0, 7  # [s], commands
_ROUND = 2 * math.pi / TURN_RATE  # [s] simulated
_NUMBER = re.compile(r"(?<![\w.])\d+\.(\d+)(?![\w.])")
_MOMENT = 0.5  # [s]
_NOISE = 0.03  # [m]


@dataclass(frozen=True, slots=True)
class _Heard:
    """A command and when it came [s]."""

    time: float
    twist: Twist


def check_mover(stage: Stage, command: Sequence[str]) -> Iterator[Row]:
    """Rows about a program that drives the Dolly in a circle."""
    heard: list[_Heard] = []
    path: list[Odometry] = []
    stage.listen(Twist, _VELOCITY, lambda twist: heard.append(_Heard(time.monotonic(), twist)))
    stage.listen(Odometry, _TRUTH, path.append)
    program = stage.start(command)
    stage.wait(lambda: heard or program.code is not None, _FIRST)
    if not heard:
        yield _silent(
            program, "commands the robot", "messages that come", f"publish on {_VELOCITY}"
        )
        return
    stage.wait(lambda: len(heard) > _SOME, _SOME / RATE * 2)
    yield _rate_row(heard)
    yield _command_row(heard[-1].twist)
    path.clear()
    began = stage.time
    stage.wait(lambda: stage.time - began > _ROUND or program.code is not None, 3 * _ROUND)
    yield _circle_row(path)
    yield ends_on_ctrl_c(program)


def _rate_row(heard: Sequence[_Heard]) -> Row:
    gaps = [after.time - before.time for before, after in pairwise(heard)]
    rate = 1 / statistics.fmean(gaps) if gaps else 0.0
    return row(
        "rate of commands",
        f"{RATE:g} Hz within {BAND:.0%}",
        f"{rate:.2f} Hz",
        is_ok=is_within(rate, RATE),
        hint="a timer of 0.5 s that publishes once each time",
    )


def _command_row(twist: Twist) -> Row:
    forward, turn_rate = twist.linear.x, twist.angular.z
    return row(
        "velocity commanded",
        f"{FORWARD:g} m/s, {TURN_RATE:g} rad/s",
        f"{forward:g} m/s, {turn_rate:g} rad/s",
        is_ok=math.isclose(forward, FORWARD) and math.isclose(turn_rate, TURN_RATE),
        hint="linear.x and angular.z; everything else stays 0",
    )


def _circle_row(path: Sequence[Odometry]) -> Row:
    places = [odometry.pose.pose.position for odometry in path]
    radius = fit_radius([(place.x, place.y) for place in places])
    return row(
        "circle that it drives",
        f"{RADIUS:.3f} m within {BAND:.0%}",
        "none" if radius is None else f"{radius:.3f} m",
        is_ok=radius is not None and is_within(radius, RADIUS),
        hint="its radius is speed / turn rate; a command must come before the last one is too old",
    )


def check_reader(stage: Stage, command: Sequence[str]) -> Iterator[Row]:
    """Rows about a program that prints what the laser measures; the robot stands still."""
    scans: list[LaserScan] = []
    stage.listen(LaserScan, _SCAN, scans.append)
    program = stage.start(command)
    stage.wait(lambda: _lines(program) > 1 or program.code is not None, _FIRST)
    stage.wait(lambda: program.code is not None, _MOMENT)  # several lines may be a crash
    what, wanted = "prints ranges", "ranges of the scan"
    if not _lines(program) or program.code is not None:
        yield _silent(program, what, wanted, f"print what comes on {_SCAN}")
        return
    if not scans and not stage.wait(lambda: scans, 2.0):
        yield Row(what, wanted, "no scan came", is_ok=False, hint="does the simulator still run?")
        return
    found = ranges_in(program.printed(), scans[-1].ranges)
    yield row(
        what,
        wanted,
        f"{', '.join(found[:3])} m" if found else f"none; it says: {program.last_words()}",
        is_ok=bool(found) and _lines(program) > 1,
        hint="print some of scan.ranges with two decimals, again and again",
    )
    yield ends_on_ctrl_c(program)


def ranges_in(text: str, ranges: Sequence[float]) -> list[str]:
    """The numbers in a text that are ranges of a scan, but for rounding and noise [m]."""
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


def _silent(program: CheckedProgram, what: str, wanted: str, task: str) -> Row:
    if program.code is not None:
        return fate(what, program, wanted)
    hint = f"does it {task}? lcmtools wtf beside it says whether it is connected"
    return Row(what, wanted, f"none within {_FIRST:g} s", is_ok=False, hint=hint)
