"""The checks of a lab on a recorded run, as far as a log allows.

A log has only messages. Output, saved files, keys, the end of a program, and velocities that were
never desired cannot be judged; they are listed for each program.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from lcmtools.bag.log import Log
from lcmtools.labs.catalogue import Lab, LabProgram
from lcmtools.labs.checks import dolly, husky, path
from lcmtools.labs.checks.check import Explanation
from lcmtools.labs.checks.diagnosis import velocity_of
from lcmtools.labs.checks.evaluation import Sample, Velocity, log_rows
from lcmtools.labs.checks.observations import TrueState
from lcmtools.labs.checks.recorder import PATH, Recorder, read_log
from lcmtools.labs.checks.results import CheckResult, Report
from lcmtools.labs.checks.step_response import REST, Step, StepRun, is_at_rest, judge
from lcmtools.types.air_lab0 import ControllerEvaluationStat
from lcmtools.types.nav_msgs import Odometry

_EVERY = 5  # samples, until a step is looked at again
_RECENT = 3  # odometry messages, one of which a sample of an evaluator is of


@dataclass(frozen=True, slots=True)
class NotJudged:
    """A requirement that the log does not cover, and the reason."""

    program: str
    what: str
    reason: str

    def __str__(self) -> str:
        """Format it as one line."""
        return f"{self.program}, {self.what}: {self.reason}"


Rows = Iterator[CheckResult | NotJudged]
Judge = Callable[[Recorder], Rows]


def check_log(
    lab: Lab, log: Log, judges: Mapping[str, Judge] | None = None
) -> tuple[list[Report], list[NotJudged]]:
    """Return the reports of a lab's programs in a log, and the requirements that were not judged.

    ``judges`` are others than those of a recorded run, by the program's option.

    Raises:
        LcmtoolsError: The log has no topics of the lab.
    """
    reports, others = [], list[NotJudged]()
    for run in read_log(lab, log):
        program, observed = run.program, run.observations()
        explanation = Explanation(lambda observed=observed: observed)  # type: ignore[misc]
        results = []
        judge = (judges or JUDGES).get(program.option, _nothing)
        for row in judge(run):
            if isinstance(row, NotJudged):
                others.append(row)
            else:
                results.append(replace(explanation.of(row), said=""))
        if results:
            command = (str(log.path),)
            reports.append(
                Report(program.option, command, results, observed, duration=log.duration)
            )
    return reports, others


def _controller(run: Recorder) -> Rows:
    if not run.commands:
        yield _no_message(run, *run.program.publishes)
        return
    runs = list(_steps(run))
    for step in husky.STEPS:
        found = [step_run for step_run in runs if step_run.step == step]
        whole = [step_run for step_run in found if step_run.is_over()]
        if whole:
            yield judge(whole[-1])
        elif found:
            longest = max(step_run.duration for step_run in found)
            reason = f"it was desired for only {longest:.1f} s"
            yield NotJudged(run.program.option, step.title, reason)
        else:
            start = "at 1 m/s" if step == REST else "from rest"
            reason = f"it was never desired {start}"
            yield NotJudged(run.program.option, step.title, reason)


def _steps(run: Recorder) -> Iterator[StepRun]:
    """Yield the steps of the desired velocity that begin like the lab's steps."""
    motion, commands = run.odometry, run.commands
    ends = [desire.time for desire in run.desired[1:]] + [math.inf]
    for desire, end in zip(run.desired, ends, strict=False):  # none where nothing was desired
        step = Step(desire.forward, desire.turn_rate)
        before = [state for state in motion if state.time <= desire.time][-1:]
        if not (before[0].forward > husky.FASTEST.forward / 2 if before and step == REST
                else is_at_rest(before)):  # fmt: skip
            continue
        states = [state for state in motion if desire.time < state.time < end]
        own = [command for command in commands if desire.time < command.time < end]
        for size in [*range(_EVERY, len(states), _EVERY), len(states)]:
            seen = states[:size]
            since = [command for command in own if seen and command.time <= seen[-1].time]
            found = StepRun(step, seen, since, (), run.rate)
            if found.is_over():
                break
        yield found


def _evaluator(run: Recorder) -> Rows:
    samples = list(_samples(run))
    yield from log_rows(samples) if samples else [_no_message(run, *run.program.publishes)]


def _samples(run: Recorder) -> Iterator[Sample]:
    """Yield an evaluator's messages, with the last velocities that came before each."""
    topics = run.name("odometry"), run.name("desired_velocity"), *run.program.publishes
    measured, desired = list[Velocity](), list[Velocity]()
    for message in (received.message for received in run.received if received.topic in topics):
        if isinstance(message, Odometry) and (velocity := velocity_of(message.twist.twist)):
            measured = [*measured, velocity][-_RECENT:]
        elif velocity := velocity_of(message):
            desired = [*desired, velocity][-2:]
        elif isinstance(message, ControllerEvaluationStat) and measured and desired:
            yield Sample(message, [(want, has) for want in desired for has in measured])


def _path(run: Recorder) -> Rows:
    program, commands, motion = run.program, run.commands, run.motion
    topics = {PATH: run.path, program.publishes[0]: commands, run.name("ground_truth"): motion}
    if not all(topics.values()):
        yield _no_message(run, *(name for name, values in topics.items() if not values))
        return
    drive = path.DrivenPath(run.path)
    for state in motion:
        if state.time >= commands[0].time and not drive.is_over(state.time):
            drive.add(state)
    first, *others = path.judge(drive, (), commands)
    if drive.offsets and not drive.is_over(motion[-1].time):
        reason = f"the log ends after {drive.along:.1f} of {drive.length:.1f} m"
        yield NotJudged(program.option, first.what, reason)
    else:
        yield first
    yield from others


def _mover(run: Recorder) -> Rows:
    commands = run.commands
    if not commands:
        yield _no_message(run, *run.program.publishes)
        return
    yield from dolly.command_rows(commands, run.end)
    first, last = commands[0].time, commands[-1].time
    states = [state for state in run.motion if first <= state.time <= last]
    circle = _last_part(states, dolly.ROUND)
    if circle:
        yield dolly.circle_row(circle, (), commands)
    else:
        reason = (
            f"a round takes {dolly.ROUND:.1f} s, but the log has only {last - first:.1f} s of it"
        )
        yield NotJudged(run.program.option, "circle that it drives", reason)


def _last_part(states: Sequence[TrueState], seconds: float) -> list[TrueState]:
    """Return the states of the last seconds; none if the run is shorter."""
    if not states or states[-1].time - states[0].time < seconds:
        return []
    return [state for state in states if state.time >= states[-1].time - seconds]


def _nothing(run: Recorder) -> Rows:
    option = run.program.option
    yield NotJudged(option, "all of it", f"{_ELSEWHERE[option]} not in a log")


def _no_message(run: Recorder, *topics: str) -> NotJudged:
    names = " or ".join(topics)
    return NotJudged(
        run.program.option, "all of it", f"there are no messages on {names} in the log"
    )


JUDGES: Mapping[str, Judge] = {
    "controller": _controller,
    "evaluator": _evaluator,
    "path": _path,
    "mover": _mover,
}
"""By the program's option."""


def can_play(program: LabProgram) -> bool:
    """Return whether a program's answers to a recorded drive can be judged."""
    return program.option in (*JUDGES, "reader")


_ELSEWHERE = {
    "teleop": "the keys that were pressed are",
    "viewer": "the picture that it saves is",
    "reader": "the lines that it prints are",
}
"""The things that the other programs are judged by, with their verb."""
