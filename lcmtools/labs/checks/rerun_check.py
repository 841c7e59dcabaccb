"""The check of a program on a recorded drive: it is run with the log, as by ``bag rerun``.

There is no physics: the motion in the log is another program's. So a controller and a follower of a
path are judged by their commands alone, at each moment of the drive; all other programs as in a
recorded run.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from lcmtools.bag.log import Log
from lcmtools.bag.rerunning.rerun import rerun
from lcmtools.bag.rerunning.rerun_report import Rerun, save
from lcmtools.labs.catalogue import Lab, LabProgram
from lcmtools.labs.checks import path
from lcmtools.labs.checks.check import built
from lcmtools.labs.checks.choice import Run
from lcmtools.labs.checks.diagnosis import velocity_of
from lcmtools.labs.checks.dolly import last_scan, printed_rows
from lcmtools.labs.checks.log_check import JUDGES, NotJudged, Rows, check_log
from lcmtools.labs.checks.observations import last_failure
from lcmtools.labs.checks.recorded_run import RecordedRun
from lcmtools.labs.checks.results import CheckResult, Report
from lcmtools.labs.checks.steering_formula import steering_cause
from lcmtools.messages.registry import Message
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import JointState

_FULL = 0.99  # effort
_CHANGE = 0.05, 0.05  # [m/s] and [rad/s] of a desired velocity that must be answered
_MOTION = 0.05, 0.02  # [m/s] and [rad/s] of a measured change that must be answered
_AGREES = 0.3  # correlation above which commands rise with the measured velocity
_TURNS = 0.2  # [rad/s] of the recorded robot, to one side beyond doubt
_MOST = 0.8  # of the commands


class _Moment(NamedTuple):
    """A command, and what the program knew; each a forward part and a turning part."""

    desired: tuple[float, float]
    measured: tuple[float, float]
    command: tuple[float, float]
    is_free: bool  # an effort that is not at its limit


def check_rerun(lab: Lab, run: Run, log: str) -> tuple[Report, list[NotJudged]]:
    """Return the report of a program that is run with a log, and what was not judged.

    Raises:
        LcmtoolsError: The program cannot be built or started, or the log has no topics of the lab.
    """
    program = run.program
    lab = replace(lab, programs=(program,))
    with built(run) as command, TemporaryDirectory(prefix="lcmtools-check-") as folder:
        result = rerun(log, command, outputs=program.publishes)
        new = str(Path(folder, "rerun.lcmlog"))
        save(result, new, force=False)
        with Log(new) as saved:
            printed = "\n".join(result.run.last_lines)
            scan = last_scan(saved) if program.option == "reader" else None
            judges = {**JUDGES, "controller": _controller, "path": _path}
            if scan:
                judges["reader"] = lambda *_: printed_rows(printed, scan)
            reports, others = check_log(lab, saved, judges)
    rows = [_end_row(result, program), *(row for one in reports for row in one.results)]
    seen = reports[0].observations if reports else None
    return Report(program.option, run.command, rows, seen, run.is_answer, result.duration), others


def _end_row(result: Rerun, program: LabProgram) -> CheckResult:
    """Return the row for a program that must hear the drive, speak, and not fail."""
    wrong = [*result.run.errors, *filter(None, [result.run.trouble])]
    if not wrong and program.publishes and not any(map(result.now.get, program.publishes)):
        wrong = list(result.trouble) or ["it published nothing"]
    lines = result.run.last_lines
    hint = "; ".join([*wrong, *result.notes]) if wrong else ""
    said = str(last_failure("\n".join(lines)) or lines[-1]) if wrong and lines else ""
    measured = f"{result.run.inputs} messages" if not wrong else "it does not"
    return CheckResult("runs with the drive", "to its end", measured, not wrong, hint, said=said)


def _moments(run: RecordedRun, program: LabProgram) -> Iterator[_Moment]:
    topics = (run.name("desired_velocity"), run.name("odometry"), *program.publishes)
    events = [
        (recorded.arrival, topic in program.publishes, recorded.message)
        for topic in topics
        for recorded in run.topics.get(topic, ())
    ]
    desired = measured = (0.0, 0.0)
    for _, is_command, message in sorted(events, key=lambda event: event[:2]):
        if isinstance(message, Odometry):
            twist = message.twist.twist
            measured = twist.linear.x, twist.angular.z
        elif is_command and (command := _parts(message)):
            efforts = message.effort if isinstance(message, JointState) else ()
            is_free = bool(efforts) and max(map(abs, efforts)) < _FULL
            yield _Moment(desired, measured, command, is_free)
        elif isinstance(message, Twist) and not is_command:
            desired = message.linear.x, message.angular.z


def _parts(message: Message) -> tuple[float, float] | None:
    """Return the part of a command that drives forward, and that which turns to the left."""
    if not isinstance(message, JointState):
        return velocity_of(message)
    sides = list(message.effort or message.velocity)
    if len(sides) != len(("left", "right")):
        return None
    left, right = sides if list(message.name) != ["right", "left"] else sides[::-1]
    return (left + right) / 2, (right - left) / 2


def _controller(run: RecordedRun, program: LabProgram) -> Rows:
    moments = list(_moments(run, program))
    for axis, (name, unit) in enumerate((("speed", "m/s"), ("turn rate", "rad/s"))):
        yield _desired_row(moments, axis, name, unit) or NotJudged(
            program.option, f"desired {name}", "it is always the same in the log"
        )
        if any(moment.is_free for moment in moments):
            yield _measured_row(moments, axis, name) or NotJudged(
                program.option, f"measured {name}", "it is always the same in the log"
            )


def _desired_row(moments: Sequence[_Moment], axis: int, name: str, unit: str) -> CheckResult | None:
    """Return the row for commands that must rise and fall with what is desired; None if not."""
    answers = []
    for before, after in pairwise([_Moment((0, 0), (0, 0), (0, 0), is_free=True), *moments]):
        wanted = after.desired[axis] - before.desired[axis]
        if abs(wanted) >= _CHANGE[axis]:
            answers.append((after.command[axis] - before.command[axis]) * math.copysign(1, wanted))
    if not answers:
        return None
    right, wrong = sum(one > 0 for one in answers), sum(one < 0 for one in answers)
    sign = f"wrong sign: a greater desired {name} [{unit}] must give a greater command"
    component = "linear.x" if axis == 0 else "angular.z"
    hint = sign if wrong > right else f"does it use {component} of each desired velocity?"
    measured, is_ok = f"{right} of {len(answers)}", right > 0 and not wrong
    return CheckResult(f"answers a new desired {name}", "each time", measured, is_ok, hint)


def _measured_row(moments: Sequence[_Moment], axis: int, name: str) -> CheckResult | None:
    """Return the row for efforts that must fall when what is measured rises; None if not."""
    steady = [
        (after.measured[axis] - before.measured[axis], after.command[axis] - before.command[axis])
        for before, after in pairwise(moments)
        if before.desired == after.desired and before.is_free and after.is_free
    ]
    if math.fsum(abs(one) for one, _ in steady) < _MOTION[axis]:
        return None
    size = math.sqrt(math.fsum(a * a for a, _ in steady) * math.fsum(b * b for _, b in steady))
    agreement = math.fsum(a * b for a, b in steady) / size if size else 0.0
    is_ok = bool(size) and agreement < _AGREES
    measured = "it falls" if is_ok else "it rises" if size else "it stays the same"
    hint = "wrong sign: the error is the desired velocity minus the measured one"
    if not size:
        hint = f"its effort is the same whatever the measured {name} is"
    return CheckResult(f"measured {name} rises", "less effort", measured, is_ok, hint)


def _path(run: RecordedRun, program: LabProgram) -> Rows:
    points, states = run.path(), run.motion("ground_truth", "odometry")
    commands = run.commands(program)
    if not (points and states and commands):
        yield NotJudged(program.option, "its turns", "the log needs a path and the robot's poses")
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
    hint = cause.text if cause else "wrong sign of turn: left is angular.z above 0"
    measured = f"{sum(sides)} of {len(sides)}"
    is_ok = sum(sides) >= _MOST * len(sides) and not cause
    yield CheckResult("turns to the side of the path", f"{_MOST:.0%}", measured, is_ok, hint)
