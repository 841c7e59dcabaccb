"""lab check of programs that drive, with a planted fault: the cause is named, and once."""

import pytest
from fixtures.says import assert_says

pytestmark = pytest.mark.usefixtures("quiet_network")

TELEOP = """
import sys, tty
import lcmtools
from lcmtools import Node
from lcmtools.types.geometry_msgs import Twist

FAULT = sys.argv[1]
lcmtools.init()
node = Node("teleop")
publisher = node.create_publisher(Twist, "/RosAria/cmd_vel")
tty.setraw(0) if FAULT == "raw" else tty.setcbreak(0)
ways = {"i": (1, 0), ",": (-1, 0), "j": (0, 1), "l": (0, -1), "u": (1, 1), "o": (1, -1),
        "m": (-1, -1), ".": (-1, 1)}
if FAULT == "capitals":
    ways["O"] = ways.pop("o")
if FAULT == "unknown":
    del ways["u"]
if FAULT == "key-jl":
    ways["j"], ways["l"] = ways["l"], ways["j"]
factors = {"q": (1.1, 1.1), "w": (1.1, 1), "e": (1, 1.1), "z": (0.9, 0.9), "x": (0.9, 1),
           "c": (1, 0.9)}
speed = turn = 1.0
try:
    while True:
        key = sys.stdin.read(1)
        if FAULT in ("capitals", "unknown") and key not in ways | factors | {"k": 0}:
            publisher.publish(twist)
            continue
        faster, more_turn = factors.get(key, (1, 1))
        speed, turn = speed * faster, turn * more_turn
        along, around = ways[key] if FAULT == "died" else ways.get(key, (0, 0))
        around = -around if FAULT == "turn-sign" else around
        twist = Twist()
        twist.linear.x, twist.angular.z = along * speed, around * turn
        publisher.publish(twist)
except KeyboardInterrupt:
    publisher.publish(Twist())
while FAULT == "endless":
    pass
lcmtools.shutdown()
"""
MOVER = """
import sys
import lcmtools
from lcmtools import Node
from lcmtools.types.geometry_msgs import Twist

FAULT = sys.argv[1]
lcmtools.init()
node = Node("moving_robot")
publisher = node.create_publisher(Twist, "/dolly/cmd_vel")
twist = Twist()
twist.linear.x, twist.angular.z = 0.5, 0.0 if FAULT == "velocity" else 0.3


def move():
    if FAULT != "once" or node.get_clock().now() < start + 10**9:
        publisher.publish(twist)


start = node.get_clock().now()
node.create_timer(500.0 if FAULT == "timer" else 0.5, move)
lcmtools.spin(node)
"""

FOLLOWER = """
import sys, time
import lcmtools
from lcmtools import Node
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry

FAULT = sys.argv[1]
lcmtools.init()
node = Node("path_follower")
publisher = node.create_publisher(Twist, "/RosAria/cmd_vel")
twist = Twist()


def drive(odometry):
    twist.linear.x = 0.4
    publisher.publish(twist)
    if FAULT == "busy":
        time.sleep(0.5)
    elif odometry.pose.pose.position.x > 0.0:
        lcmtools.shutdown()


node.create_subscription(Odometry, "/ground_truth", drive, 1)
lcmtools.spin(node)
"""

WRONG_ANGLE = """
import math, sys
import lcmtools
from lcmtools import Node
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry, Path

FAULT = sys.argv[1]


class Follower(Node):
    def __init__(self):
        super().__init__("path_follower")
        self.points = []
        self.publisher = self.create_publisher(Twist, "/RosAria/cmd_vel")
        self.create_subscription(Path, "/path", self.take, 1)
        self.create_subscription(Odometry, "/ground_truth", self.drive, 1)

    def take(self, path):
        places = [one.pose.position for one in path.poses]
        self.points = self.points or [(one.x, one.y) for one in places]

    def drive(self, truth):
        pose, twist = truth.pose.pose, Twist()
        x, y, turn = pose.position.x, pose.position.y, pose.orientation
        while self.points[1:] and math.dist(self.points[0], (x, y)) < 0.4:
            self.points.pop(0)
        if self.points:
            dx, dy = self.points[0][0] - x, self.points[0][1] - y
            heading = turn.z if FAULT == "yaw" else 2 * math.atan2(turn.z, turn.w)
            heading = math.degrees(heading) if FAULT == "degrees" else heading
            way = math.atan2(dx, dy) if FAULT == "exchanged" else math.atan2(dy, dx)
            way = math.atan(dy / dx) if FAULT == "atan" else way
            twist.linear.x = 0.4
            twist.angular.z = 2.0 * math.remainder(way - heading, math.tau)
            self.publisher.publish(twist)


lcmtools.init()
lcmtools.spin(Follower())
"""

UNSTOPPED = """
import lcmtools
from lcmtools.labs.nodes.path_follower import PathFollower


class Unstopped(PathFollower):
    def _odometry_callback(self, odometry):
        super()._odometry_callback(odometry)
        if self._pursuit and self._pursuit.nearest >= len(self._pursuit._points) - 4:
            lcmtools.shutdown()


lcmtools.init()
lcmtools.spin(Unstopped())
"""


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ("key-jl", "'j' does what 'l' should do (right on the spot): the keys are mixed up"),
        ("turn-sign", "wrong sign of turn: left is angular.z above 0"),
        ("capitals", "'O' does it, and 'o' does not: the keys are lower-case letters"),
        ("unknown", "'u' changes nothing: is it in the program's table of keys, in lower case?"),
        ("died", "the program died: it ended with code 1: KeyError: 'k'"),
        ("endless", "let the loop end at Ctrl-C"),
        ("raw", "in a raw terminal Ctrl-C is the key"),
    ],
)
def test_the_cause_of_wrong_keys_is_named_once(fault, words, check):
    first, *others = check("pioneer", "teleop", TELEOP, fault)
    assert words in first["hint"]
    assert all(other["follows"] == first["what"] for other in others), others


@pytest.mark.parametrize(
    ("fault", "measured", "words"),
    [
        ("once", "0.00 Hz", "one command came, and no other for"),
        ("timer", "none within", "a period of 500 s; if 500 ms are meant, write 0.5"),
    ],
)
def test_the_cause_of_a_wrong_mover_is_named(fault, measured, words, check):
    first, *others = check("dolly", "mover", MOVER, fault)
    assert str(first["measured"]).startswith(measured)
    assert words in first["hint"]
    assert all(other["follows"] == first["what"] for other in others), others


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ("busy", "its callback of /ground_truth runs for 0."),
        ("ended", "it gets no farther than ("),
    ],
)
def test_the_cause_of_a_path_that_is_not_followed_is_named(fault, words, check):
    first, *others = check("pioneer", "path", FOLLOWER, fault)
    assert first["what"] == "drives the path"
    assert words in first["hint"]
    assert all(other["follows"] == first["what"] for other in others), others


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ("atan", "its turns fit atan(dy/dx)"),
        ("exchanged", "its turns fit atan2(dx, dy)"),
        ("degrees", "its turns fit a heading in degrees"),
        ("yaw", "its turns fit orientation.z in place of the heading"),
    ],
)
def test_a_mistake_in_the_angle_to_the_path_is_named(fault, words, check):
    first, *others = check("pioneer", "path", WRONG_ANGLE, fault)
    assert first["cause"] == "angle", first
    assert words in first["hint"]
    assert all(other["follows"] == first["what"] for other in others), others


def test_a_program_that_ends_and_leaves_its_robot_driving_is_not_right(check):
    (row,) = check("pioneer", "path", UNSTOPPED, "no-stop")
    assert row["what"] == "stops at the end"
    assert str(row["measured"]).startswith("+0.400 m/s")
    assert "publish a final Twist of 0" in row["hint"]


def test_a_program_that_goes_on_at_the_end_of_the_path_is_not_right(check):
    called, end = (
        "        super()._odometry_callback(odometry)\n",
        "            lcmtools.shutdown()\n",
    )
    source = UNSTOPPED.replace(called, "").replace(end, f"            return\n{called}")
    (row,) = check("pioneer", "path", source, "no-stop")
    assert (row["what"], row["wanted"]) == ("stops at the end", "at rest within 3 s")
    assert "at the last point publish a Twist of 0" in row["hint"]


def test_a_robot_that_got_stuck_says_on_what_and_where(check):
    first, circle = check("dolly", "mover", MOVER, "velocity")
    assert first["measured"] == "0.5 m/s, 0 rad/s"
    assert "set linear.x and angular.z" in first["hint"]
    assert circle["follows"] == first["what"]
    assert "stuck on shed, at (5.1, 0.0) m" in circle["measured"]


@pytest.fixture
def class_folder(tmp_path):
    folder = tmp_path / "class"
    (folder / "anna" / "anna").mkdir(parents=True)
    source = "def main(): pass\n" + MOVER.replace("sys.argv[1]", "''")
    (folder / "anna" / "anna" / "moving_robot.py").write_text(source)
    # a package of which a file is not declared as a node: here the file itself is run
    (folder / "anna" / "pyproject.toml").write_text('[project]\nname = "anna"\n[tool.lcmtools]\n')
    (folder / "anna" / "yaml.py").write_text("raise ImportError('not for the check')")
    (folder / "bo.py").write_text("raise ValueError('/dolly/cmd_vel')")
    (folder / "cy").mkdir()
    yield folder
    assert sorted(path.name for path in folder.iterdir()) == ["anna", "bo.py", "cy"]


def test_a_class_is_checked_with_a_table_a_report_and_pictures(class_folder, tmp_path, cli):
    files = ("--junit", str(tmp_path / "class.xml"), "--plot", str(tmp_path / "plot.png"))
    command = ("lab", "check", "dolly", "--programs", str(class_folder), "--jobs", "2", *files)
    result = cli(*command)
    assert result.code == 1
    table = [row.split(maxsplit=4) for row in result.out.splitlines()[-3:]]
    assert table[0] == ["anna", "4", "of", "4"]
    assert table[1][:4] == ["bo.py", "0", "of", "1"]
    assert "ValueError: /dolly/cmd_vel (bo.py:1)" in table[1][4]
    assert table[2][:2] == ["cy", "-"]
    assert_says(table[2][4], "not contain", "moving_robot or reading_laser")
    report = (tmp_path / "class.xml").read_text()
    assert report.count("<testsuite ") == 3
    assert (tmp_path / "plot_anna_mover.png").read_bytes().startswith(b"\x89PNG")
