"""The check of a program on a recorded drive: it is run with the log, as by ``bag rerun``.

There is no physics: the motion in the log is another program's. So a controller and a follower of a
path are judged by their commands alone, at each moment of the drive; all other programs as in a
recorded run.
"""

import math
from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from lcmtools.bag.log import Log
from lcmtools.bag.rerunning.programs import Program, Tested
from lcmtools.bag.rerunning.rerun import rerun
from lcmtools.bag.rerunning.rerun_report import Rerun, save
from lcmtools.bag.rerunning.session import Input
from lcmtools.labs.catalogue import Lab, LabProgram
from lcmtools.labs.checks import path
from lcmtools.labs.checks.check import built
from lcmtools.labs.checks.checked_programs import own_path
from lcmtools.labs.checks.choice import Run
from lcmtools.labs.checks.diagnosis import velocity_of
from lcmtools.labs.checks.dolly import last_scan, printed_rows
from lcmtools.labs.checks.log_check import JUDGES, NotJudged, Rows, can_play, check_log
from lcmtools.labs.checks.observations import last_failure
from lcmtools.labs.checks.recorder import Recorder, known_topics
from lcmtools.labs.checks.results import CheckResult, Report
from lcmtools.labs.checks.steering_formula import steering_cause
from lcmtools.messages.registry import Message
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import JointState

_FULL = 0.99  # effort
_CHANGE = 0.05  # [m/s] or [rad/s] of a desired velocity that must be answered
_FASTER = 0.05  # [m/s] and [rad/s] that are added to what is measured, to see the answer
_TURNS = 0.2  # [rad/s] of the recorded robot, to one side beyond doubt
_MOST = 0.8  # of the commands


class _Command(NamedTuple):
    """A command at a time of the log [s]: its forward part, and the turning part."""

    time: float
    parts: tuple[float, float]
    is_free: bool  # an effort that is not at its limit


_Desired = tuple[float, float, float]  # from a time of the log on [s]: forward, turning


def check_rerun(lab: Lab, run: Run, log: str) -> tuple[Report | None, list[NotJudged]]:
    """Return the report of a program that is run with a log, if any, and what was not judged.

    Raises:
        LcmtoolsError: The program cannot be built or started, or the log has no topics of the lab.
    """
    program = run.program
    if not can_play(program):
        reason = "it is driven by keys, or shows a picture"
        return None, [NotJudged(program.option, "all of it", reason)]
    lab = replace(lab, programs=(program,))
    with Log(log) as drive:
        known_topics(lab, drive)
    with built(run) as command, TemporaryDirectory(prefix="lcmtools-check-") as folder:
        python_first = {"PATH": own_path(), "NO_COLOR": "1"}
        tested = Tested([Program(program.option, command, python_first)])
        result = rerun(log, tested, outputs=program.publishes)
        commands = list(_commands(result, program))
        judges = {**JUDGES, "path": _path}
        if program.option == "controller" and commands:
            faster = partial(_faster, f"{lab.robot}/odometry")
            second = rerun(log, tested, outputs=program.publishes, inputs=faster)
            others = {one.time: one for one in _commands(second, program)}
            pairs = [(one, others[one.time]) for one in commands if one.time in others]
            judges["controller"] = partial(_controller, commands, pairs)
        new = str(Path(folder, "rerun.lcmlog"))
        save(result, new, force=False)
        with Log(new) as saved:
            if program.option == "reader" and (scan := last_scan(saved)):
                printed = "\n".join(result.run.last_lines)
                judges["reader"] = lambda *_: printed_rows(printed, scan)
            reports, left_out = check_log(lab, saved, judges)
    rows = [_end_row(result, program), *(row for one in reports for row in one.results)]
    seen = reports[0].observations if reports else None
    return Report(program.option, run.command, rows, seen, run.is_answer, result.duration), left_out


def _faster(odometry: str, one: Input) -> Input:
    """Add a little to the velocities that a program is told."""
    if one.topic == odometry and isinstance(one.message, Odometry):
        one.message.twist.twist.linear.x += _FASTER
        one.message.twist.twist.angular.z += _FASTER
    return one


def _end_row(result: Rerun, program: LabProgram) -> CheckResult:
    """Return the row for a program that must hear the drive, speak, and not fail."""
    wrong = [one.partition("\n")[0] for one in (*result.run.errors[:1], result.run.trouble) if one]
    if not wrong and program.publishes and not any(map(result.now.get, program.publishes)):
        wrong = ["it published nothing"]
    lines = result.run.last_lines
    hint = "; ".join([*wrong, *result.notes]) if wrong else ""
    said = str(last_failure("\n".join(lines)) or lines[-1]) if wrong and lines else ""
    measured = f"{result.run.inputs} messages" if not wrong else "it does not"
    return CheckResult("runs with the drive", "to its end", measured, not wrong, hint, said=said)


def _commands(result: Rerun, program: LabProgram) -> Iterator[_Command]:
    for topic in program.publishes:
        for one in result.now.get(topic, ()):
            message = result.read(topic, one.payload)
            efforts = message.effort if isinstance(message, JointState) else ()
            if parts := _parts(message):
                is_free = bool(efforts) and max(map(abs, efforts)) < _FULL
                yield _Command(one.time / 1e9, parts, is_free)


def _parts(message: Message) -> tuple[float, float] | None:
    """Return the part of a command that drives forward, and that which turns to the left."""
    if not isinstance(message, JointState):
        return velocity_of(message)
    sides = list(message.effort or message.velocity)
    if len(sides) != len(("left", "right")):
        return None
    left, right = sides if list(message.name) != ["right", "left"] else sides[::-1]
    return (left + right) / 2, (right - left) / 2


def _controller(
    commands: Sequence[_Command],
    pairs: Sequence[tuple[_Command, _Command]],
    run: Recorder,
) -> Rows:
    desired = [(0.0, 0.0, 0.0)]
    for received in run.received:
        if received.topic == run.name("desired_velocity"):
            velocity = velocity_of(received.message)
            if velocity and velocity != desired[-1][1:]:
                desired.append((received.arrival, *velocity))
    for axis, name in enumerate(("speed", "turn rate")):
        what, reason = f"answers a new desired {name}", "it is always the same in the log"
        row = _desired_row(desired, commands, axis, what)
        yield row or NotJudged(run.program.option, what, reason)
        if any(one.is_free and two.is_free for one, two in pairs):
            yield _measured_row(pairs, axis, name)


def _desired_row(
    desired: Sequence[_Desired], commands: Sequence[_Command], axis: int, what: str
) -> CheckResult | None:
    """Return the row for commands that must rise and fall with what is desired, if that changes."""
    times, answers = [command.time for command in commands], []
    for (_, *old), (time, *new) in pairwise(desired):
        change, before, after = (
            new[axis] - old[axis],
            bisect_left(times, time),
            bisect_right(times, time),
        )
        if abs(change) >= _CHANGE and after < len(commands):
            before = bisect_left(times, time) - 1
            value = commands[before].parts[axis] if before >= 0 else 0.0
            answers.append((commands[after].parts[axis] - value) * math.copysign(1.0, change))
    if not answers:
        return None
    right, wrong = sum(one > 0 for one in answers), sum(one < 0 for one in answers)
    component = ("linear.x", "angular.z")[axis]
    hint = f"does it use {component} of each desired velocity?"
    if wrong > right:
        hint = f"wrong sign: with {component} of the desired velocity the command must rise"
    measured = f"{right} of {len(answers)} times"
    return CheckResult(what, "each time", measured, right > 0 and not wrong, hint)


def _measured_row(pairs: Sequence[tuple[_Command, _Command]], axis: int, name: str) -> CheckResult:
    """Return the row for efforts that must be less where more is measured."""
    free = [(one.parts[axis], two.parts[axis]) for one, two in pairs if one.is_free and two.is_free]
    less, more = sum(two < one for one, two in free), sum(two > one for one, two in free)
    is_ok = less >= _MOST * len(free) > 0
    measured = "less" if is_ok else "more" if more > less else "the same"
    hint = "wrong sign: the error is the desired velocity minus the measured one"
    if more <= less:
        hint = f"its effort is the same whatever the measured {name} is"
    return CheckResult(f"at a higher measured {name}", "less effort", measured, is_ok, hint)


def _path(run: Recorder) -> Rows:
    points, states, commands, program = run.path, run.motion, run.commands, run.program.option
    if not (points and states and commands):
        yield NotJudged(program, "its turns", "the log needs a path and the robot's poses")
        return
    share = f"{path.EACH:.0%} of {len(states)}"
    is_enough = len(commands) >= path.EACH * len(states)
    hint = "publish a command for each pose"
    yield CheckResult("commands for poses", share, f"{len(commands)}", is_enough, hint)
    turning = {round(state.time, 3): state.turn_rate for state in states}
    sides = [
        velocity[1] * turn > 0
        for one in commands
        if (velocity := velocity_of(one.message))
        and abs(turn := turning.get(round(one.time, 3), 0.0)) > _TURNS
    ]
    cause = steering_cause(points, states, commands)
    what = "turns to the side of the path"
    if not sides:
        yield NotJudged(program, what, "the recorded robot does not turn")
        return
    hint = cause.text if cause else "wrong sign of turn: left is angular.z above 0"
    measured = f"{sum(sides)} of {len(sides)}"
    is_ok = sum(sides) >= _MOST * len(sides) and not cause
    yield CheckResult(what, f"{_MOST:.0%}", measured, is_ok, hint)
