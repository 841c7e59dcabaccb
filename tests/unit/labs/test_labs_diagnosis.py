"""The causes that checks give, from records of what was observed; no processes."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import pytest

from lcmtools.labs.catalogue import LABS
from lcmtools.labs.checks import dolly, husky
from lcmtools.labs.checks.diagnosis import DIED, SELDOM, SILENT, ZERO, cause_of, misplaced
from lcmtools.labs.checks.driving_keys import DRIVING_KEYS, KeyPress, key_cause
from lcmtools.labs.checks.observations import (
    BusLook,
    CommandMessage,
    Failure,
    Observations,
    Touch,
    TrueState,
    Wire,
    last_failure,
    last_words,
)
from lcmtools.labs.checks.results import CheckResult
from lcmtools.labs.checks.step_response import REST, Step, StepRun, judge
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


INTERRUPTED = """\
Traceback (most recent call last):
  File "/home/anna/simple_controller.py", line 60, in <module>
KeyboardInterrupt
"""
SYNTAX_ERROR = """\
  File "/home/anna/simple_controller.py", line 12
    if speed > 0
                ^
SyntaxError: expected ':'
"""
WINDOWS = r"""\
/usr/bin/env: 'python\r': No such file or directory
/usr/bin/env: use -[v]S to pass options in shebang lines
"""


def missing(module: str) -> str:
    return f"""\
Traceback (most recent call last):
  File "/home/anna/simple_controller.py", line 1, in <module>
ModuleNotFoundError: No module named '{module}'
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
    assert last_words(SYNTAX_ERROR) == "SyntaxError: expected ':' (simple_controller.py:12)"
    assert last_words(TRACEBACK + INTERRUPTED) == expected
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
        ({"code": 1, "printed": missing("rclpy.node")}, DIED, "; here it is lcmtools: import lcm"),
        ({"code": 1, "printed": missing("nav_msgs")}, DIED, "; here it is lcmtools.types.nav_msgs"),
        (
            {"code": 1, "printed": missing("lcmtools.types.nav_msgs.msg")},
            DIED,
            "; here it is lcmtools.types.nav_msgs",
        ),
        ({"code": 127, "printed": WINDOWS}, DIED, "; its lines end as on Windows: sed -i"),
        (
            {"look": BusLook()},
            "no-node",
            "neither a node nor a message of it is on the check's bus",
        ),
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
            "it publishes std_msgs/String on /husky0/velocity_cmd, but sensor_msgs/JointSt",
        ),
        (
            {"look": replace(WELL, subscriptions=[Wire("/odometry"), INPUTS[1]])},
            "subscription",
            "not to /husky0/odometry: change the name in it, or start it with /odometry:=/hus",
        ),
        (
            {"look": replace(WELL, subscriptions=INPUTS[:1])},
            "unsubscribed",
            "it does not subscribe to /husky0/desired_velocity",
        ),
        ({"look": replace(WELL, runs_callbacks=False)}, "spin", "lcmtools.spin(node)"),
        (
            {"look": replace(WELL, subscriptions=[replace(INPUTS[0], longest=7.5), INPUTS[1]])},
            "busy",
            "its callback of /husky0/odometry runs for 7.5 s",
        ),
        (
            {"look": replace(WELL, subscriptions=[replace(INPUTS[0], busy=250.0), INPUTS[1]])},
            "busy",
            "it must return at once, without a sleep",
        ),
        (
            {"look": replace(WELL, subscriptions=[replace(INPUTS[0], offered="a_msgs/A")])},
            "type",
            "it subscribes to /husky0/odometry as nav_msgs/Odometry, but a_msgs/A is published",
        ),
        (
            {"look": replace(WELL, subscriptions=[*INPUTS, Wire("/a", "b/B", offered="a_msgs/A")])},
            "type",
            "it subscribes to /a as b/B, but a_msgs/A is published",
        ),
        (
            {"look": WELL, "printed": "[WARN] [/a]: create_timer: a period of 50 s; if 50 ms ..."},
            "timer",
            "its timer has not been called yet: create_timer: a period of 50 s; if 50 ms",
        ),
        (
            {"look": WELL},
            "publish",
            "its callbacks run (calls: 500), but publish() is never called",
        ),
        (
            {"look": replace(WELL, publications=[])},
            "publisher",
            "it does not create a publisher of",
        ),
        (
            {"look": BusLook([NODE])},
            "publisher",
            "it does not create a publisher of /husky0/velocity_cmd",
        ),
    ],
)
def test_the_cause_of_silence_is_named(changes: dict[str, Any], key: str, words: str) -> None:
    observed = replace(Observations(CONTROLLER), **changes)
    cause = cause_of(SILENT_ROW, observed)
    assert (cause.key, words in cause.text) == (key, True), cause


@pytest.mark.parametrize(
    ("topic", "callback", "given", "key"),
    [
        ("/camera/depth/image", "/camera/depth/image", SILENT, "subscription"),
        ("/camera/depth/image", "timer 0.1 s", SILENT, "raised"),
        ("/camera/depth/image_raw", "/camera/depth/image_raw", SILENT, "raised"),
        ("/camera/rgb/image_raw", "", "unlike", "subscription"),
        ("/camera/depth/image_raw", "", "unlike", "unlike"),
    ],
)
def test_a_wrong_input_explains_the_exception_and_the_picture_that_come_of_it(
    topic: str, callback: str, given: str, key: str
) -> None:
    row = CheckResult("shows the depth", "90%", "78%", is_ok=False, cause=given)
    failures = [Failure("ValueError", "size", "v.py:3", 86, callback)] if callback else []
    look = replace(WELL, subscriptions=[Wire(topic, "sensor_msgs/Image")], failures=failures)
    cause = cause_of(row, Observations(LABS["pioneer"].programs[1], look=look))
    assert cause.key == key
    assert (f"subscribes to {topic}, and not to /camera/depth/image_raw:" in cause.text) == (
        key == "subscription"
    )


@pytest.mark.parametrize(
    ("callback", "count", "key"),
    [
        ("/husky0/odometry", 49, "slow"),
        ("/husky0/odometry", 51, "raised"),
        ("/husky0/desired_velocity", 50, "raised"),
        ("timer 0.1 s", 9, "slow"),
        ("timer 0.1 s", 11, "raised"),
    ],
)
def test_an_exception_now_and_then_is_not_why_the_robot_is_too_slow(
    callback: str, count: int, key: str
) -> None:
    row = CheckResult("drive at 0.1 m/s", "0.1 m/s", "0.05 m/s", is_ok=False, cause="slow")
    failure = Failure("KeyError", "'a'", "c.py:3", count, callback)
    commands = [CommandMessage(0.0, OUTPUT.topic, effort(1, 1))] * 100
    look = replace(WELL, failures=[failure])
    assert cause_of(row, Observations(CONTROLLER, commands, look=look)).key == key


@pytest.mark.parametrize("key", [SELDOM, ZERO])
def test_a_callback_that_waits_is_why_commands_come_too_seldom_or_as_before(key: str) -> None:
    row = CheckResult("drive at 0.1 m/s", "0.1 m/s", "0.05 m/s", is_ok=False, cause=key)
    slow = replace(INPUTS[0], calls=10, longest=0.5, busy=5.0)
    look = replace(WELL, subscriptions=[slow])
    cause = cause_of(row, Observations(CONTROLLER, look=look))
    assert cause.text.startswith("its callback of /husky0/odometry runs for 0.5 s: it must return")


def test_a_program_of_keys_is_not_advised_to_spin() -> None:
    teleop = Observations(LABS["pioneer"].programs[0], look=BusLook(["/teleop"]))
    cause = cause_of(replace(SILENT_ROW, hint="read single keys"), teleop)
    assert cause.text == "read single keys"


def step_run(
    step: Step,
    reached: tuple[float, float],
    message: Any,
    count: int = 400,
    touches: Sequence[Touch] = (),
) -> StepRun:
    motion = [TrueState(i / 50, 0.0, 0.0, *reached) for i in range(400)]
    commands = [CommandMessage(i * 8 / max(count, 1), "/husky0/velocity_cmd", message)
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
    run: StepRun, key: str, words: str
) -> None:
    row = judge(run)
    assert (row.cause, words in row.hint) == (key, True), row


def varied_run(
    step: Step, speeds: Callable[[float], tuple[float, float]], force: Callable[[float], float]
) -> StepRun:
    """A step of 8 s, with the velocity and the effort of both sides at each time [s]."""
    times = [i / 50 for i in range(400)]
    motion = [TrueState(t, 0.0, 0.0, *speeds(t)) for t in times]
    commands = [
        CommandMessage(t, "/husky0/velocity_cmd", effort(force(t), force(t))) for t in times
    ]
    return StepRun(step, motion, commands)


def rising(time: float) -> float:
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
def test_the_cause_of_a_wrong_speed_is_told_by_the_efforts(
    run: StepRun, key: str, words: str
) -> None:
    row = judge(run)
    assert (row.is_ok, row.cause, words in row.hint) == (False, key, True), row


def test_a_robot_that_stands_is_watched_no_longer_than_its_effort_changes() -> None:
    still = varied_run(FORWARD, lambda _: (0.0, 0.0), lambda _: 0.01)
    growing = varied_run(FORWARD, lambda _: (0.0, 0.0), lambda t: t / 1000)
    seen = [replace(run, motion=run.motion[:250], commands=run.commands[:250])
            for run in (still, growing)]  # fmt: skip
    assert [run.is_over() for run in seen] == [True, False]


def test_wheel_speeds_in_place_of_efforts_are_named() -> None:
    message = JointState()
    message.velocity = [0.3, 0.3]
    run = step_run(FORWARD, (0.1, 0.0), message)
    row = judge(run)
    assert row.cause == "field"
    assert row.hint.startswith("its commands are in velocity, and the wheels are driven by effo")


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
    assert husky.error_cause(measured, Step(0.3, 0.4)) == words


def presses(change: Any) -> dict[str, KeyPress]:
    motion, found = Motion(0.5, 1.0), {}
    for key in DRIVING_KEYS:
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
            "'j' does what 'l' should do (right on the spot): the keys are mixed up",
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
    assert "one command came, and no other for 8.0 s" in dolly.rate_cause(1, 0.0, 8.0).text
    assert "9 commands came, and then none for 5.0 s" in dolly.rate_cause(9, 2.0, 5.0).text
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
