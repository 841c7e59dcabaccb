"""The causes that checks give, from records of what was observed; no processes."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest

from lcmtools.labs.catalogue import LABS
from lcmtools.labs.checks import dolly, husky
from lcmtools.labs.checks.diagnosis import DIED, SILENT, cause_of, misplaced
from lcmtools.labs.checks.measures import analyse
from lcmtools.labs.checks.observations import (
    BusLook,
    Command,
    Failure,
    Observations,
    Sample,
    Touch,
    Wire,
    last_failure,
    last_words,
)
from lcmtools.labs.checks.pioneer import DIRECTIONS, KeyPress, key_cause
from lcmtools.labs.checks.results import CheckResult
from lcmtools.labs.nodes.driving.motion import Motion
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.sensor_msgs import JointState

CONTROLLER = LABS["husky"].programs[0]
SILENT_ROW = CheckResult("commands the robot", "messages", "none", is_ok=False, cause=SILENT)
NODE = "/husky0/simple_controller"
INPUTS = [
    Wire("/husky0/odometry", "nav_msgs/Odometry", 500, 500),
    Wire("/husky0/desired_velocity", "geometry_msgs/Twist", 50, 50),
]
OUTPUT = Wire("/husky0/velocity_cmd", "sensor_msgs/JointState")
WELL = BusLook([NODE], [OUTPUT], INPUTS, runs_callbacks=True)
TRACEBACK = """\
[INFO] hello
Traceback (most recent call last):
  File "/usr/lib/python3/site-packages/lcmtools/node/node.py", line 12, in _call
    callback(message)
  File "/home/anna/simple_controller.py", line 35, in odometry_callback
    error = self.desird.linear.x
  File "/usr/lib/python3.11/lib/python/x.py", line 2, in get
AttributeError: 'C' object has no attribute 'desird'
"""


def twist(forward: float, turn_rate: float, **others: float) -> Twist:
    message = Twist()
    message.linear.x, message.angular.z = forward, turn_rate
    message.linear.y = others.get("sideways", 0.0)
    return message


def effort(left: float, right: float) -> JointState:
    message = JointState()
    message.effort = [left, right]
    return message


def test_a_traceback_is_one_line_with_the_place_in_the_student_s_own_file() -> None:
    expected = "AttributeError: 'C' object has no attribute 'desird' (simple_controller.py:35)"
    assert str(last_failure(TRACEBACK)) == expected
    assert last_words(TRACEBACK + "[INFO] later\n") == expected
    assert last_words("one\n two \n\n") == "two"
    assert last_words("") == ""


@pytest.mark.parametrize(
    ("changes", "key", "words"),
    [
        ({"code": 3, "printed": "oops\n"}, DIED, "the program died: it ended with code 3: oops"),
        ({"code": -11}, DIED, "it was ended by SIGSEGV: it printed nothing"),
        ({"printed": TRACEBACK}, "raised", "it raised AttributeError"),
        (
            {"look": replace(WELL, failures=[Failure("KeyError", "'a'", "c.py:3", 340, "/odom")])},
            "raised",
            "its callback of /odom raised 340 times KeyError: 'a' (c.py:3)",
        ),
        (
            {"warnings": ["/husky0/velocity_cmd: command ignored: unknown wheel 'l'"]},
            "ignored",
            "the robot ignores its commands on /husky0/velocity_cmd: unknown wheel 'l'",
        ),
        ({"look": BusLook()}, "no-node", "nothing of it is on the check's bus"),
        (
            {"look": replace(WELL, publications=[Wire("/husky0/velocty_cmd", OUTPUT.type)])},
            "topic",
            "it publishes on /husky0/velocty_cmd, and not on /husky0/velocity_cmd: ",
        ),
        (
            {"look": replace(WELL, publications=[Wire("/husky0/velocty_cmd", OUTPUT.type)])},
            "topic",
            "start it with velocty_cmd:=velocity_cmd",
        ),
        (
            {"look": replace(WELL, publications=[replace(OUTPUT, type="std_msgs/String")])},
            "type",
            "it publishes std_msgs/String on /husky0/velocity_cmd, where sensor_msgs/JointSt",
        ),
        (
            {"look": replace(WELL, subscriptions=[Wire("/odometry"), INPUTS[1]])},
            "subscription",
            "not to /husky0/odometry: change the name in it, or start it with /odometry:=/hus",
        ),
        (
            {"look": replace(WELL, subscriptions=INPUTS[:1])},
            "subscription",
            "it does not subscribe to /husky0/desired_velocity",
        ),
        ({"look": replace(WELL, runs_callbacks=False)}, "spin", "lcmtools.spin(node)"),
        (
            {"look": replace(WELL, subscriptions=[replace(INPUTS[0], longest=7.5), INPUTS[1]])},
            "busy",
            "its callback of /husky0/odometry runs for 7.5 s",
        ),
        ({"look": WELL}, "publish", "its callbacks run (500 calls), but publish() is never called"),
        ({"look": replace(WELL, publications=[])}, "publisher", "it makes no publisher of"),
    ],
)
def test_the_cause_of_silence_is_named(changes: dict[str, Any], key: str, words: str) -> None:
    observed = replace(Observations(CONTROLLER), **changes)
    cause = cause_of(SILENT_ROW, observed)
    assert (cause.key, words in cause.text) == (key, True), cause


def test_a_program_of_keys_is_not_advised_to_spin() -> None:
    teleop = Observations(LABS["pioneer"].programs[0], look=BusLook(["/teleop"]))
    cause = cause_of(replace(SILENT_ROW, hint="read single keys"), teleop)
    assert cause.text == "read single keys"


def step_run(
    step: husky.Step,
    reached: tuple[float, float],
    message: Any,
    count: int = 400,
    touches: Sequence[Touch] = (),
) -> husky.StepRun:
    motion = [Sample(i / 50, 0.0, 0.0, *reached) for i in range(400)]
    commands = [Command(i * 8 / max(count, 1), "/husky0/velocity_cmd", message)
                for i in range(count)]  # fmt: skip
    return husky.StepRun(step, motion, commands, touches)


FORWARD, TURN = husky.Step(0.5, 0.0), husky.Step(0.0, 0.3)


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
def test_the_cause_of_a_step_that_was_not_followed_is_named(
    run: husky.StepRun, key: str, words: str
) -> None:
    cause = husky.step_cause(run, analyse(run.values(), run.step.target))
    assert (cause.key, words in cause.text) == (key, True), cause


def test_wheel_speeds_in_place_of_efforts_are_named() -> None:
    message = JointState()
    message.velocity = [0.3, 0.3]
    run = step_run(FORWARD, (0.1, 0.0), message)
    cause = husky.step_cause(run, analyse(run.values(), run.step.target))
    assert cause.key == "field"
    assert cause.text.startswith("its commands are in velocity, and the wheels are driven by effo")


@pytest.mark.parametrize(
    ("measured", "words"),
    [
        (0.25, "the square, without the root"),
        (0.3, "the error of linear.x only"),
        (0.7, "the sum |v - desired v| + |w - desired w|"),
        (0.123, ""),
    ],
)
def test_the_formula_of_a_wrong_error_is_recognised(measured: float, words: str) -> None:
    assert husky.error_cause(measured, husky.Step(0.3, 0.4)) == words


def presses(change: Any) -> dict[str, KeyPress]:
    motion, found = Motion(0.5, 1.0), {}
    for key in DIRECTIONS:
        motion = motion.after(key)
        wanted = motion.forward, motion.turn_rate
        found[key] = KeyPress(key, wanted, change(key, *wanted))
    return found


@pytest.mark.parametrize(
    ("change", "key", "cause", "words"),
    [
        (lambda _, v, w: twist(v, -w), "u", "turn-sign", "wrong sign of turn: left is angular.z"),
        (lambda _, v, w: twist(-v, w), "i", "speed-sign", "wrong sign of speed"),
        (
            lambda k, v, w: twist(v, -w if k in "jl" else w),
            "j",
            "key-jl",
            "'j' does what 'l' should do (right on the spot): one key for another",
        ),
        (lambda _, v, w: twist(0, w, sideways=v), "i", "field", "it sets linear.y"),
        (lambda k, v, w: twist(v, w) if k != "o" else twist(0, 0), "o", "key-o", "'o' stops"),
        (lambda k, v, w: None if k == "o" else twist(v, w), "o", "unanswered", "nothing is publ"),
    ],
)
def test_the_cause_of_a_wrong_key_is_named(change: Any, key: str, cause: str, words: str) -> None:
    drives = presses(change)
    found = key_cause(drives[key], drives)
    assert (found.key, words in found.text) == (cause, True), found


@pytest.mark.parametrize(
    ("message", "key"),
    [
        (twist(-0.5, 0.3), "speed-sign"),
        (twist(0.5, -0.3), "turn-sign"),
        (twist(0.3, 0.5), "exchanged"),
        (twist(0.5, 17.2), "unit"),
        (twist(0.0, 0.3, sideways=0.5), "field"),
        (twist(0.4, 0.3), "velocity"),
    ],
)
def test_the_cause_of_a_wrong_velocity_is_named(message: Twist, key: str) -> None:
    assert dolly.velocity_cause(message).key == key
    assert dolly.circle_cause(1.0, [], message).key == key or key == "speed-sign"


def test_a_rate_of_0_has_its_reason() -> None:
    assert "one command came, and no other in 8.0 s" in dolly.rate_cause(1, 0.0, 8.0).text
    assert "9 commands came, and then none in 5.0 s" in dolly.rate_cause(9, 2.0, 5.0).text
    assert "too seldom, every 1 s" in dolly.rate_cause(8, 1.0, 0.5).text
    assert "too often, every 0.1 s" in dolly.rate_cause(8, 10.0, 0.0).text


def test_a_circle_that_ended_at_a_thing_says_at_which() -> None:
    cause = dolly.circle_cause(9.0, [Touch(3.0, "shed", 5.0, -0.01)], twist(0.5, 0.3))
    assert "stuck on shed, at (5.0, 0.0) m" in cause.text


def test_ranges_in_another_unit_are_recognised() -> None:
    ranges = [3.36, 3.31, 5.05, math.inf]
    cause = dolly.ranges_cause("[336.0, 331.0, 505.0]", ranges, [])
    assert cause.text.startswith("it prints centimetres")
    assert dolly.ranges_cause("hello 17", ranges, []).key == "ranges"


def test_a_twist_for_a_robot_on_wheels_has_two_fields() -> None:
    assert misplaced(twist(0.5, 0.3)) is None
    found = misplaced(twist(0.5, 0.3, sideways=0.1))
    assert found is not None
    assert "it sets linear.y" in found.text
