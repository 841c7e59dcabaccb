"""The Dolly lab: a timer that drives a circle, and the ranges of a laser."""

import math
import re
import statistics
import time
from collections import deque
from collections.abc import Iterator, Sequence
from itertools import pairwise

from lcmtools.bag.log import Log
from lcmtools.labs.checks.diagnosis import STOPPED, misplaced
from lcmtools.labs.checks.measures import BAND, fit_radius, is_within
from lcmtools.labs.checks.observations import ReceivedMessage, Touch, TrueState
from lcmtools.labs.checks.program_rows import early_end, first_command, nothing_within
from lcmtools.labs.checks.results import Cause, CheckResult
from lcmtools.labs.checks.test_bench import TestBench
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import LaserScan

_FORWARD, _TURN_RATE, _RATE = 0.5, 0.3, 2.0  # [m/s], [rad/s], [Hz]: as the lab specifies
_RADIUS = _FORWARD / _TURN_RATE
_PRINTS = "prints ranges", "ranges of the scan"
VELOCITY, _SCAN = "/dolly/cmd_vel", "/dolly/laser_scan"
_FIRST, SOME = 10.0, 8  # [s], commands
ROUND = 2 * math.pi / _TURN_RATE  # [s] simulated
_NUMBER = re.compile(r"(?<![\w.])\d+\.\d+(?![\w.])")
_VALUE = r"\b\D{0,20}?(\d+\.\d+|inf)(?![\w.])"
_DIRECTIONS = {
    "ahead": rf"\b(?:ahead|(?:in )?front|forward|straight|middle|cent(?:er|re)){_VALUE}",
    "left": rf"\bleft{_VALUE}",
    "right": rf"\bright{_VALUE}",
    "nearest": rf"\b(?:nearest|closest){_VALUE}",
}
"""Words before a range that say where it is measured."""
_MIDDLE = 0.05  # of the beams to each side of the middle one are ahead
_ANY_NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?![\w.])")
_NEWEST = 20  # numbers
_LONGEST_DRIVE = 25.0  # [s]
_SILENCE = 2.0  # [s]
_MOMENT = 0.5  # [s]
_NOISE = 0.03  # [m]


def check_mover(bench: TestBench, command: Sequence[str]) -> Iterator[CheckResult]:
    """Check a program that drives the Dolly in a circle."""
    seen = bench.recorder
    seen.record_command(Twist)
    program = bench.start(command)
    first = first_command(bench, f"does it publish on {VELOCITY}?")
    if not first.is_ok:
        yield first
        return
    bench.wait(lambda: len(seen.commands) >= SOME, SOME / _RATE * 2)
    yield from command_rows(seen.commands, time.monotonic())
    if program.code is not None:
        yield early_end("circle that it drives")
        return
    start, sample, touch = bench.time, len(seen.motion), len(seen.touches)
    longest = min(3 * ROUND, _LONGEST_DRIVE)
    bench.wait(lambda: bench.time - start > ROUND or program.code is not None, longest)
    yield circle_row(seen.motion[sample:], seen.touches[touch:], seen.commands)


def command_rows(commands: Sequence[ReceivedMessage], now: float) -> Iterator[CheckResult]:
    """Yield the rows for the rate and the velocity of commands until now [s]."""
    times = [command.arrival for command in commands]
    gaps = [after - before for before, after in pairwise(times)]
    rate = 1 / statistics.fmean(gaps) if gaps else 0.0
    cause = rate_cause(len(times), rate, now - times[-1])
    wanted, measured = f"{_RATE:g} Hz within {BAND:.0%}", f"{rate:.2f} Hz"
    is_ok = is_within(rate, _RATE)
    yield CheckResult("rate of commands", wanted, measured, is_ok, cause.text, cause.key)
    twist = last_twist(commands)
    forward, turn_rate = twist.linear.x, twist.angular.z
    is_alike = math.isclose(forward, _FORWARD) and math.isclose(turn_rate, _TURN_RATE)
    is_ok, cause = is_alike and not misplaced(twist), velocity_cause(twist)
    wanted = f"{_FORWARD:g} m/s, {_TURN_RATE:g} rad/s"
    measured = f"{forward:g} m/s, {turn_rate:g} rad/s"
    yield CheckResult("velocity commanded", wanted, measured, is_ok, cause.text, cause.key)


def last_twist(commands: Sequence[ReceivedMessage]) -> Twist:
    """Return the last command."""
    twist = commands[-1].message
    assert isinstance(twist, Twist)
    return twist


def rate_cause(count: int, rate: float, silent: float) -> Cause:
    """Return the cause of a wrong rate, from the count, the rate [Hz] and the last silence [s]."""
    timer = "a timer of 0.5 s that publishes once each time"
    if count == 1:
        text = f"one command came, and no other for {silent:.1f} s: publish in the timer's callback"
        return Cause("once", f"{text}; a period of 500 ms is 0.5 s")
    if silent > _SILENCE:
        return Cause(STOPPED, f"{count} commands came, and then none for {silent:.1f} s: {timer}")
    word = "seldom" if rate < _RATE else "often"
    return Cause("rate", f"commands come too {word}, every {1 / rate:.2g} s: {timer}")


def velocity_cause(twist: Twist) -> Cause:
    """Return the cause of a wrong velocity."""
    forward, turn_rate = twist.linear.x, twist.angular.z
    if odd := misplaced(twist):
        return odd
    if math.isclose(forward, -_FORWARD):
        return Cause("speed-sign", "wrong sign of speed: forward is linear.x above 0")
    if math.isclose(turn_rate, -_TURN_RATE):
        return Cause("turn-sign", "wrong sign of turn: left is angular.z above 0")
    if math.isclose(forward, _TURN_RATE) and math.isclose(turn_rate, _FORWARD):
        return Cause("exchanged", "speed and turn rate are exchanged")
    if math.isclose(turn_rate, math.radians(_TURN_RATE)) or turn_rate > math.pi:
        return Cause("unit", "angular.z is in rad/s, not in degrees")
    return Cause("velocity", "set linear.x and angular.z; everything else stays 0")


def circle_row(
    path: Sequence[TrueState], touches: Sequence[Touch], commands: Sequence[ReceivedMessage]
) -> CheckResult:
    """Return the row for the circle that a robot has driven."""
    radius = fit_radius([(place.x, place.y) for place in path])
    cause = circle_cause(radius, touches, last_twist(commands))
    stuck = f", stuck on {touches[0]}" if touches else ""
    wanted = f"{_RADIUS:.3f} m within {BAND:.0%}"
    measured = f"{'none' if radius is None else f'{radius:.3f} m'}{stuck}"
    is_ok = radius is not None and is_within(radius, _RADIUS)
    return CheckResult("circle that it drives", wanted, measured, is_ok, cause.text, cause.key)


def circle_cause(radius: float | None, touches: Sequence[Touch], twist: Twist) -> Cause:
    """Return the cause of a wrong circle; the commanded velocity may explain it."""
    velocity = velocity_cause(twist)
    commanded = twist.linear.x / twist.angular.z if twist.angular.z else math.inf
    if not is_within(commanded, _RADIUS):
        return velocity
    if touches:
        return Cause("stuck", f"the robot is stuck on {touches[0]}")
    if radius is None:
        text = "the robot did not drive: do commands keep coming? It stops without new ones"
        return Cause("no-drive", text)
    return Cause("circle", "each command must come before the previous one expires")


def check_reader(bench: TestBench, command: Sequence[str]) -> Iterator[CheckResult]:
    """Check a program that prints the measurements of the laser, with a robot at rest."""
    scans = bench.recorder.record(LaserScan, _SCAN)
    program = bench.start(command)
    bench.wait(lambda: _lines(program.printed()) > 1 or program.code is not None, _FIRST)
    bench.wait(lambda: program.code is not None, _MOMENT)  # several lines may be a crash
    if program.code is not None or not _lines(program.printed()):
        hint = f"does it print the messages on {_SCAN}?"
        yield nothing_within(program, _FIRST, *_PRINTS, hint)
        return
    if not bench.wait(lambda: scans, 2.0):
        hint = "does the simulator still run?"
        yield CheckResult(*_PRINTS, "no scan came", is_ok=False, hint=hint)
        return
    yield from printed_rows(program.printed(), scans[-1])


def printed_rows(printed: str, scan: LaserScan) -> Iterator[CheckResult]:
    """Yield the rows for what a program prints of a scan."""
    found = ranges_in(printed, scan.ranges)
    cause = ranges_cause(printed, scan.ranges, found)
    measured = f"{', '.join(found[:3])} m" if found else "none"
    is_ok = bool(found) and _lines(printed) > 1
    yield CheckResult(*_PRINTS, measured, is_ok, cause.text, cause.key)
    yield from direction_rows(printed, scan)


def last_scan(log: Log) -> LaserScan | None:
    """Return the last scan of a log, if it has one."""
    scans = log.messages(_SCAN, on_error=lambda _: None) if _SCAN in log.topics else ()
    found = deque((arrival.message for arrival in scans), 1)
    return found[0] if found and isinstance(found[0], LaserScan) else None


def direction_rows(printed: str, scan: LaserScan) -> Iterator[CheckResult]:
    """Yield the row for the directions that a program prints with its ranges, if it prints any."""
    size, wanted, wrong = len(scan.ranges), list[str](), ""
    half, few = size // 2, round(size * _MIDDLE)
    nearest = min(range(size), key=scan.ranges.__getitem__)
    beams = {
        "ahead": range(half - few, half + few + 1),
        "left": range(half - 1, size),
        "right": range(half + 1),
        "nearest": range(nearest, nearest + 1),
    }
    for name, pattern in _DIRECTIONS.items():
        said = re.findall(pattern, printed.replace(",", "\n"), re.IGNORECASE)
        found = _beams(said[-1], scan.ranges) if said else []
        if found:
            wanted.append(name)
        if found and not wrong and not {*found} & {*beams[name]}:
            angle = math.degrees(scan.angle_min + found[0] * scan.angle_increment)
            side = "left" if angle > 0 else "right"
            wrong = (
                f"{name} {said[-1]}, which is ranges[{found[0]}], {abs(angle):.0f} degrees {side}"
            )
    if wanted:
        hint = "ranges go from angle_min (right) to angle_max (left): ahead is the middle one,"
        hint += " ranges[len(ranges) // 2], and the last one is at the left"
        title = f"prints what is {', '.join(wanted)}"
        yield CheckResult(title, "the beams there", wrong or "they are", not wrong, hint, "beam")


def _beams(number: str, ranges: Sequence[float]) -> list[int]:
    """Return the beams that measure a printed range."""
    tolerance = 0.5 * 10.0 ** -len(number.partition(".")[2]) + _NOISE
    value = float(number)
    return [i for i, one in enumerate(ranges) if one == value or abs(one - value) <= tolerance]


def ranges_in(text: str, ranges: Sequence[float]) -> list[str]:
    """Return the numbers in a text that equal ranges of a scan [m], but for rounding and noise."""
    found = {match[0] for match in _NUMBER.finditer(text) if _beams(match[0], ranges)}
    return sorted(found, key=float)


def ranges_cause(printed: str, ranges: Sequence[float], found: Sequence[str]) -> Cause:
    """Return the reason why a program's output has no ranges, or only one line of them."""
    if found:
        return Cause("once", "it prints only once: print in the callback, for each message")
    numbers = _ANY_NUMBER.findall(printed)[-_NEWEST:]
    for unit, factor in (("centimetres", 100.0), ("millimetres", 1000.0)):
        scaled = [f"{float(number) / factor:.3f}" for number in numbers]
        if 2 * sum(bool(ranges_in(number, ranges)) for number in scaled) > len(scaled) > 1:
            return Cause(
                "unit", f"it prints {unit}: ranges are in metres, and should be printed in metres"
            )
    return Cause("ranges", "print some of scan.ranges with two decimals, repeatedly")


def _lines(printed: str) -> int:
    return sum(bool(line.strip()) for line in printed.splitlines())
