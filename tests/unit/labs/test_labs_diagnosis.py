"""The causes that checks give, from records of what was observed; no processes."""

from dataclasses import replace

import pytest

from lcmtools.labs.catalogue import LABS
from lcmtools.labs.checks.diagnosis import DIED, SELDOM, SILENT, STOPPED, ZERO, busy, cause_of
from lcmtools.labs.checks.observations import (
    BusLook,
    Failure,
    Observations,
    ReceivedMessage,
    Wire,
    last_failure,
    last_words,
)
from lcmtools.labs.checks.results import CheckResult
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


CPP_CALLBACK = """\
[ERROR] [1.2] [/mine]: timer 0.5 s raised std::out_of_range: vector::_M_range_check (mine.cpp:14)
[ERROR] [1.7] [/mine]: callback of /odom raised std::bad_any_cast: bad any_cast (mine.cpp:20)
[INFO] [1.8] [/mine]: it was raised to 3 m
"""
CPP_END = """\
[INFO] hello
terminate called after throwing an instance of 'std::runtime_error'\r
  what():  cannot write a.pgm\r
"""


def missing(module):
    return f"""\
Traceback (most recent call last):
  File "/home/anna/simple_controller.py", line 1, in <module>
ModuleNotFoundError: No module named '{module}'
"""


@pytest.mark.parametrize(
    ("printed", "says"),
    [
        (CPP_CALLBACK, "std::bad_any_cast: bad any_cast (mine.cpp:20)"),
        (CPP_END, "std::runtime_error: cannot write a.pgm"),
        (f"{CPP_CALLBACK}{CPP_END}", "std::runtime_error: cannot write a.pgm"),
    ],
)
def test_an_exception_of_a_program_in_cpp_is_known(printed, says):
    assert str(last_failure(printed)) == says
    assert last_failure("[INFO] it was raised to 3 m\n") is None


def test_a_traceback_is_one_line_with_the_place_in_the_student_s_own_file():
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
            "it begins with /, so __ns:=/husky0 does not apply: write 'odometry'",
        ),
        (
            {"look": replace(WELL, publications=[Wire("/controlled_velocity", OUTPUT.type)])},
            "topic",
            "neither __ns:=/husky0 nor controlled_velocity:=velocity_cmd applies: write 'contr",
        ),
        (
            {"look": replace(WELL, publications=[Wire("/velocity_cmd", OUTPUT.type)])},
            "topic",
            "it begins with /, so __ns:=/husky0 does not apply: write 'velocity_cmd'",
        ),
        (
            {"look": replace(WELL, nodes=["/c"], subscriptions=[Wire("/odometry"), INPUTS[1]])},
            "subscription",
            "not to /husky0/odometry: start it with __ns:=/husky0",
        ),
        (
            {"look": replace(WELL, nodes=["/a/c"], subscriptions=[Wire("/odometry"), INPUTS[1]])},
            "subscription",
            "change the name in it, or start it with /odometry:=/husky0/odometry",
        ),
        (
            {
                "look": replace(
                    WELL, nodes=["/c"], publications=[Wire("/velocity_cmd", OUTPUT.type)]
                )
            },
            "topic",
            "not on /husky0/velocity_cmd: start it with __ns:=/husky0",
        ),
        (
            {"look": replace(WELL, subscriptions=[Wire("odometry"), INPUTS[1]])},
            "subscription",
            "it subscribes to odometry, and not to /husky0/odometry: let it subscribe to /husky0/",
        ),
        (
            {"look": BusLook([], [Wire("velocity_cmd", OUTPUT.type)])},
            "topic",
            "it publishes on velocity_cmd, and not on /husky0/velocity_cmd: change the name in it",
        ),
        (
            {"look": replace(WELL, subscriptions=INPUTS[:1])},
            "unsubscribed",
            "it does not subscribe to /husky0/desired_velocity",
        ),
        ({"look": replace(WELL, runs_callbacks=False)}, "spin", "call spin(node)"),
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
def test_the_cause_of_silence_is_named(changes, key, words):
    observed = replace(Observations(CONTROLLER), **changes)
    cause = cause_of(SILENT_ROW, observed)
    assert (cause.key, words in cause.text) == (key, True), cause


@pytest.mark.parametrize("given", [ZERO, "unmoved-linear.x"])
def test_an_input_that_never_comes_explains_a_robot_that_does_not_move(given):
    look = replace(WELL, subscriptions=[INPUTS[0], Wire("/desired_velocity")])
    row = CheckResult("drive", "1", "0", is_ok=False, cause=given)
    cause = cause_of(row, Observations(CONTROLLER, look=look))
    assert "so __ns:=/husky0 does not apply: write 'desired_velocity'" in cause.text


@pytest.mark.parametrize(
    ("topic", "args", "space", "words"),
    [
        ("/cmd_vel", "mover", "/dolly", "so __ns:=/dolly does not apply: write 'cmd_vel'"),
        ("/cmd_vel", "path", "/RosAria", "so __ns:=/RosAria does not apply: write 'cmd_vel'"),
        ("/cmd_vel", "teleop", "/RosAria", "so __ns:=/RosAria does not apply: write 'cmd_vel'"),
    ],
)  # fmt: skip
def test_a_slash_in_a_program_of_another_lab_is_named(topic, args, space, words):
    programs = (program for lab in LABS.values() for program in lab.programs)
    program = next(program for program in programs if program.option == args)
    look = BusLook([f"{space}/mine"], [Wire(topic, "geometry_msgs/Twist")], runs_callbacks=True)
    cause = cause_of(SILENT_ROW, Observations(program, look=look))
    assert words in cause.text


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
    topic, callback, given, key
):
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
def test_an_exception_now_and_then_is_not_why_the_robot_is_too_slow(callback, count, key):
    row = CheckResult("drive at 0.1 m/s", "0.1 m/s", "0.05 m/s", is_ok=False, cause="slow")
    failure = Failure("KeyError", "'a'", "c.py:3", count, callback)
    commands = [ReceivedMessage(0.0, OUTPUT.topic, JointState(effort=[1.0, 1.0]))] * 100
    look = replace(WELL, failures=[failure])
    assert cause_of(row, Observations(CONTROLLER, commands, look=look)).key == key


@pytest.mark.parametrize("key", [SELDOM, STOPPED, ZERO, "measured"])
def test_a_callback_that_waits_is_why_commands_come_too_seldom_or_late(key):
    row = CheckResult("drive at 0.1 m/s", "0.1 m/s", "0.05 m/s", is_ok=False, cause=key)
    slow = replace(INPUTS[0], calls=10, longest=0.5, busy=5.0)
    look = replace(WELL, subscriptions=[slow])
    cause = cause_of(row, Observations(CONTROLLER, look=look))
    assert cause.text.startswith("its callback of /husky0/odometry runs for 0.5 s: it must return")


@pytest.mark.parametrize(
    ("wire", "is_busy"),
    [
        (Wire("/a", calls=6, longest=2.0, busy=12.0), True),
        (Wire("/a", calls=500, longest=2.0, busy=4.0), False),  # the first call imports something
        (Wire("/a", calls=1, longest=2.0, busy=2.0), False),
    ],
)
def test_a_callback_that_often_waits_is_known_though_all_else_is_right(wire, *, is_busy):
    look = replace(WELL, subscriptions=[wire])
    assert bool(busy(Observations(CONTROLLER, look=look), often=True)) is is_busy


def test_a_program_of_keys_is_not_advised_to_spin():
    teleop = Observations(LABS["pioneer"].programs[0], look=BusLook(["/teleop"]))
    cause = cause_of(replace(SILENT_ROW, hint="read single keys"), teleop)
    assert cause.text == "read single keys"
