"""The causes of steps that a robot does not follow, from records of its motion and commands."""

import math
from dataclasses import replace

import pytest

from lcmtools.labs.checks.observations import ReceivedMessage, Touch, TrueState
from lcmtools.labs.checks.step_response import REST, Step, StepRun, judge
from lcmtools.types.sensor_msgs import JointState


def effort(left, right):
    message = JointState()
    message.effort = [left, right]
    return message


def step_run(step, reached, message, count=400, touches=()):
    motion = [TrueState(i / 50, 0.0, 0.0, *reached) for i in range(400)]
    commands = [ReceivedMessage(i * 8 / max(count, 1), "/husky0/velocity_cmd", message)
                for i in range(count)]  # fmt: skip
    return StepRun(step, motion, commands, touches)


FORWARD, TURN = Step(0.5, 0.0), Step(0.0, 0.3)


@pytest.mark.parametrize(
    ("run", "key", "words"),
    [
        (step_run(FORWARD, (0.0, 0.0), effort(0.5, 0.5), 0), "stopped", "no command came in 8.0 s"),
        (step_run(FORWARD, (0.1, 0.0), effort(0.5, 0.5), 8), "seldom", "too seldom, 1 a second"),
        (
            step_run(FORWARD, (0.1, 0.0), effort(0.5, 0.5), 400, [Touch(1, "pillar", 4, -3)]),
            "stuck",
            "the robot is stuck on pillar, at (4.0, -3.0) m",
        ),
        (step_run(FORWARD, (-0.9, 0.0), effort(-1, -1)), "speed-sign", "wrong sign of speed"),
        (
            step_run(FORWARD, (-0.9, 0.0), effort(-1, -1), 400, [Touch(1, "yard", -5.4, 0.0)]),
            "speed-sign",
            "wrong sign of speed",
        ),
        (step_run(FORWARD, (0.5, 1.8), effort(-1, 1)), "turn-sign", "it turns at +1.80 rad/s"),
        (step_run(TURN, (0.0, -1.8), effort(1, -1)), "turn-sign", "wrong sign of turn (-1.80"),
        (step_run(TURN, (-1.0, 0.0), effort(-1, -1)), "speed-sign", "it drives at -1.00 m/s"),
        (step_run(FORWARD, (0.0, 0.0), effort(0, 0)), "zero", "its commands are all 0"),
        (step_run(FORWARD, (0.3, 0.0), effort(1, 0)), "one-side", "the right wheels is always 0"),
        (step_run(FORWARD, (0.0, 0.0), effort(0.01, 0.01)), "weak", "the largest effort is 0.010"),
        (step_run(TURN, (0.0, 0.0), effort(1, 1)), "unmoved-angular.z", "does it use angular.z?"),
        (step_run(FORWARD, (0.3, 0.0), effort(1, 1)), "slow", "too slow"),
        (step_run(FORWARD, (0.7, 0.0), effort(1, 1)), "fast", "too fast"),
    ],
)
def test_the_cause_of_a_step_that_was_not_followed_is_named(run, key, words):
    row = judge(run)
    assert (row.cause, words in row.hint) == (key, True), row


def varied_run(step, speeds, force):
    """A step of 8 s, with the velocity and the effort of both sides at each time [s]."""
    times = [i / 50 for i in range(400)]
    motion = [TrueState(t, 0.0, 0.0, *speeds(t)) for t in times]
    commands = [
        ReceivedMessage(t, "/husky0/velocity_cmd", effort(force(t), force(t))) for t in times
    ]
    return StepRun(step, motion, commands)


def rising(time):
    return min(1.0, time / 4)


@pytest.mark.parametrize(
    ("run", "key", "words"),
    [
        (
            varied_run(FORWARD, lambda _: (0.4, 0.0), lambda _: 0.4),
            "slow",
            "its effort is the same whatever the measured speed is: the odometry has it as twist.",
        ),
        (
            varied_run(FORWARD, lambda _: (1.0, 0.0), rising),
            "fast",
            "its effort grows although the speed is too high",
        ),
        (
            varied_run(FORWARD, lambda t: (t / 20, 0.0), rising),
            "slow",
            "still changing after 8 s: use a greater gain",
        ),
        (
            varied_run(FORWARD, lambda _: (0.3, 0.0), lambda t: 0.3 + 0.1 * math.exp(-t)),
            "slow",
            "let the effort grow as long as the speed is too low",
        ),
        (
            varied_run(FORWARD, lambda t: (1.0 if t < 4 else -1.0, 0.0), rising),
            "measured",
            "the effort does not follow the measured velocity",
        ),
        (varied_run(FORWARD, lambda _: (0.9, -0.4), rising), "measured", "the effort does not"),
        (
            varied_run(
                FORWARD, lambda t: (round(t * 5) % 2 + 0.2, 0.0), lambda t: round(t * 5) % 2
            ),
            "swings",
            "it oscillates around the target",
        ),
        (
            varied_run(TURN, lambda _: (0.0, math.radians(0.3)), rising),
            "unit",
            "it turns at 0.0052 rad/s, which are 0.30 in degrees",
        ),
        (
            varied_run(REST, lambda t: (math.exp(-t / 4), 0.0), rising),
            "slow",
            "still changing after 8 s",
        ),
        (
            varied_run(REST, lambda t: (0.3 - 0.01 * t, 0.0), rising),
            "slow",
            "still changing after 8 s",
        ),
        (varied_run(REST, lambda _: (1.0, 0.0), rising), "stop", "a desired velocity of 0"),
    ],
)
def test_the_cause_of_a_wrong_speed_is_told_by_the_efforts(run, key, words):
    row = judge(run)
    assert (row.is_ok, row.cause, words in row.hint) == (False, key, True), row


def test_a_robot_that_stands_is_watched_no_longer_than_its_effort_changes():
    still = varied_run(FORWARD, lambda _: (0.0, 0.0), lambda _: 0.01)
    growing = varied_run(FORWARD, lambda _: (0.0, 0.0), lambda t: t / 1000)
    seen = [replace(run, motion=run.motion[:250], commands=run.commands[:250])
            for run in (still, growing)]  # fmt: skip
    assert [run.is_over() for run in seen] == [True, False]


def test_wheel_speeds_in_place_of_efforts_are_named():
    message = JointState()
    message.velocity = [0.3, 0.3]
    run = step_run(FORWARD, (0.1, 0.0), message)
    row = judge(run)
    assert row.cause == "field"
    assert row.hint.startswith("its commands are in velocity, and the wheels are driven by effo")
