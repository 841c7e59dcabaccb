"""lab check of Husky programs with a planted fault: the cause is named, within 30 s, and once."""

import json
import shlex
import sys

import pytest

pytestmark = pytest.mark.usefixtures("quiet_network")

CONTROLLER = """
import sys, time
import lcmtools
from lcmtools import Node
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.sensor_msgs import JointState

FAULT = sys.argv[1]


class Controller(Node):
    def __init__(self):
        super().__init__("simple_controller")
        output = "velocity_comand" if FAULT == "topic" else "controlled_velocity"
        output = "/controlled_velocity" if FAULT == "slash-remap" else output
        source = "/odometry" if FAULT == "subscription" else "odometry"
        goal = "/desired_velocity" if FAULT == "slash-input" else "desired_velocity"
        self.publisher = self.create_publisher(JointState, output)
        self.create_subscription(Odometry, source, self.take_odometry, 1)
        self.create_subscription(Twist, goal, self.take_desired, 1)
        self.desired = Twist()
        self.count = self.driving = 0
        self.last = 0.0
        self.left = self.right = 0.0

    def take_desired(self, twist):
        self.desired = twist
        if FAULT == "sleeps":
            time.sleep(0.3)

    def take_odometry(self, odometry):
        self.count += 1
        if FAULT == "clock" and time.monotonic() - self.last < 0.06:
            return
        self.last = time.monotonic()
        if FAULT == "busy":
            time.sleep(0.5)
        while FAULT == "endless" and self.desired.linear.x:
            pass
        forward = self.desired.linear.x - odometry.twist.twist.linear.x
        turn = self.desired.angular.z - odometry.twist.twist.angular.z
        if FAULT == "raised" or (FAULT == "sometimes" and self.count % 20 == 7):
            self.desird
        if FAULT == "publish" or (FAULT == "seldom" and self.count % 50):
            return
        self.driving += self.desired.linear.x > 0
        if FAULT == "died" and self.driving > 20:
            raise SystemExit("no more efforts")
        forward = -forward if FAULT == "speed-sign" else forward
        turn = -turn if FAULT == "turn-sign" else turn
        self.left = max(-1.0, min(1.0, self.left + 0.1 * forward - 0.05 * turn))
        self.right = max(-1.0, min(1.0, self.right + 0.1 * forward + 0.05 * turn))
        message = JointState()
        message.name = ["l", "r"] if FAULT == "ignored" else []
        efforts = [self.left, self.right]
        if FAULT == "field":
            message.velocity = efforts
        else:
            message.effort = [0.0, 0.0] if FAULT == "zero" else efforts
        self.publisher.publish(message)


lcmtools.init()
node = Controller()
if FAULT == "twice":
    other = Controller()
if FAULT == "spin":
    time.sleep(1000)
lcmtools.spin(node)
"""
EVALUATOR = """
import math, sys
import lcmtools
from lcmtools import Node
from lcmtools.types.air_lab0 import ControllerEvaluationStat
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry

FAULT = sys.argv[1]


class Evaluator(Node):
    def __init__(self):
        super().__init__("evaluate_controller")
        source = "/odometry" if FAULT == "slash" else "odometry"
        self.publisher = self.create_publisher(ControllerEvaluationStat, "evaluation_stat")
        self.create_subscription(Odometry, source, self.take_odometry, 100)
        self.create_subscription(Twist, "desired_velocity", self.take_desired, 1)
        self.desired, self.errors, self.count = None, [], 0

    def take_desired(self, twist):
        self.desired = twist
        if FAULT == "reset":
            self.errors, self.count = [], 0
        self.count += FAULT == "both"

    def take_odometry(self, odometry):
        if self.desired is None:
            return
        has, want = odometry.twist.twist, self.desired
        v, w = has.linear.x - want.linear.x, has.angular.z - want.angular.z
        error = {
            "square": v * v + w * w,
            "linear": abs(v),
            "angular": abs(w),
            "y": abs(has.linear.y - want.linear.y),
            "manhattan": abs(v) + abs(w),
            "ignores": math.hypot(want.linear.x, want.angular.z),
            "exchanged": math.hypot(
                has.linear.x - want.angular.z, has.angular.z - want.linear.x
            ),
        }.get(FAULT, math.hypot(v, w))
        self.errors.append(error)
        self.count += FAULT != "late"
        size, squares = len(self.errors), sum(e * e for e in self.errors)
        message = ControllerEvaluationStat()
        message.samples, message.last_error = self.count, error
        message.average_error = {
            "mean": sum(self.errors) / size,
            "mean-square": squares / size,
            "sum": squares,
            "root-sum": math.sqrt(squares),
            "minus-1": math.sqrt(squares / max(1, size - 1)),
            "last": error,
        }.get(FAULT, math.sqrt(squares / size))
        self.count += FAULT == "late"
        self.publisher.publish(message)


lcmtools.init()
lcmtools.spin(Evaluator())
"""


@pytest.mark.parametrize(
    ("fault", "row", "words"),
    [
        ("raised", "commands the robot", "AttributeError"),
        ("topic", "commands the robot", "start it with velocity_comand:=velocity_cmd"),
        (
            "subscription",
            "commands the robot",
            "/odometry, and not to /husky0/odometry: it begins with",
        ),
        (
            "slash-remap",
            "commands the robot",
            "__ns:=/husky0 nor controlled_velocity:=velocity_cmd",
        ),
        ("slash-input", "drive at 0.1 m/s", "does not apply: write 'desired_velocity'"),
        ("publish", "commands the robot", "publish() is never called"),
        ("spin", "commands the robot", "does it call spin(node)"),
        ("died", "drive at 0.1 m/s", "the program died: it ended with code 1: no more efforts"),
        ("ignored", "drive at 0.1 m/s", "unknown wheel 'l'"),
        ("field", "drive at 0.5 m/s", "its commands are in velocity"),
        ("seldom", "drive at 0.1 m/s", "commands come too seldom, "),
        ("zero", "drive at 0.1 m/s", "its commands are all 0"),
        ("speed-sign", "drive at 0.1 m/s", "wrong sign of speed (-1.00 m/s instead of +0.1)"),
        ("turn-sign", "turn at 0.3 rad/s", "wrong sign of turn"),
        ("busy", "drive at 0.1 m/s", "its callback of /husky0/odometry runs for 0."),
        ("endless", "drive at 0.1 m/s", "its callback of /husky0/odometry runs for "),
        ("sleeps", "callbacks return at once", "its callback of /husky0/desired_velocity runs for"),
        ("sometimes", "raises no exception", "callback of /husky0/odometry raised"),
    ],
)
def test_the_cause_of_a_wrong_controller_is_named_once(fault, row, words, check):
    first, *others = check("husky", "controller", CONTROLLER, fault)
    assert first["what"] == row, first
    assert first["cause"] == {
        "sometimes": "raised",
        "slash-remap": "topic",
        "slash-input": "subscription",
        **dict.fromkeys(("endless", "sleeps"), "busy"),
    }.get(fault, fault)
    assert words in first["hint"]
    assert first["said"]
    assert all(other["follows"] == row for other in others), others
    advice = " ".join([first["hint"], *first["findings"]])
    assert "lcmtools wtf" not in advice
    assert "lcmtools node" not in advice


@pytest.mark.parametrize(
    ("fault", "row", "words"),
    [
        ("mean", "average_error remembers", "it is the mean of the errors, and should be the root"),
        ("mean-square", "average_error", "it is the mean of the squares, without the root"),
        ("sum", "average_error", "it is the sum of the squares, without the mean and the root"),
        ("root-sum", "average_error", "it is the root of the sum of the squares, not of their"),
        ("minus-1", "average_error", "it is divided by the samples minus 1"),
        ("last", "average_error remembers", "it is the last error alone"),
        ("square", "last_error", "it is the square, without the root"),
        ("linear", "last_error", "it is the error of linear.x only"),
        ("angular", "last_error", "it is the error of angular.z only"),
        ("y", "last_error", "it is always 0"),
        ("manhattan", "last_error", "it is the sum |v - desired v| + |w - desired w|"),
        ("ignores", "last_error of a moving robot", "it is the length of the desired velocity"),
        ("exchanged", "last_error of a moving robot", "made with linear.x and angular.z exchanged"),
        ("reset", "samples", "it starts again: go on counting when another desired velocity"),
        ("both", "samples", "count in the odometry callback, and only there"),
        (
            "slash",
            "publishes",
            "it begins with /, so __ns:=/husky0 does not apply: write 'odometry",
        ),
        ("late", "samples", "count a sample before you publish it"),
    ],
)
def test_a_wrong_statistic_of_an_evaluator_is_named(fault, row, words, check):
    first, *others = check("husky", "evaluator", EVALUATOR, fault)
    assert first["what"] == row, first
    assert words in first["hint"]
    assert all(other["follows"] or words in other["hint"] for other in others), others


@pytest.mark.parametrize(
    ("fault", "findings"),
    [("clock", []), ("twice", ["2 nodes have the name /husky0/simple_controller"])],
)
def test_a_program_is_right_that_goes_by_the_real_clock_or_has_what_wtf_notes(
    fault, findings, cli, tmp_path
):
    script = tmp_path / "program.py"
    script.write_text(CONTROLLER)
    command = f"{shlex.join([sys.executable, str(script)])} {fault}"
    result = cli("lab", "check", "husky", "--controller", command, "--json")
    assert result.code == 0, result.out
    noted = [one.partition(":")[0] for row in json.loads(result.out)["rows"]
             for one in row["findings"]]  # fmt: skip
    assert noted == findings
