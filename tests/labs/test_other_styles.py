"""Programs that do what a lab asks for in another way than the model answers."""

import json
import shlex
import sys

import pytest

SELECTING = """
import select, sys, termios, tty
import lcmtools
from lcmtools import Node
from lcmtools.types.geometry_msgs import Twist

WAYS = {"i": (1, 0), ",": (-1, 0), "j": (0, 1), "l": (0, -1), "u": (1, 1), "o": (1, -1),
        "m": (-1, -1), ".": (-1, 1)}
FACTORS = {"q": (1.1, 1.1), "w": (1.1, 1), "e": (1, 1.1), "z": (0.9, 0.9), "x": (0.9, 1),
           "c": (1, 0.9)}
lcmtools.init()
node = Node("teleop_twist_keyboard")
publisher = node.create_publisher(Twist, "/RosAria/cmd_vel", 1)
along = around = 0
speed, turn = 0.5, 1.0


def publish():
    twist = Twist()
    twist.linear.x, twist.angular.z = along * speed, around * turn
    publisher.publish(twist)


before = termios.tcgetattr(sys.stdin)
while lcmtools.ok():
    tty.setcbreak(sys.stdin.fileno(), termios.TCSANOW)
    ready, _, _ = select.select([sys.stdin], [], [], 0.1)
    key = sys.stdin.read(1) if ready else ""  # what is typed at the same moment waits for the next
    termios.tcsetattr(sys.stdin, termios.TCSANOW, before)
    if key in FACTORS:
        faster, more_turn = FACTORS[key]
        speed, turn = speed * faster, turn * more_turn
    elif key:
        along, around = WAYS.get(key, (0, 0))
        publish()
along = around = 0
publish()
lcmtools.shutdown()
"""
RAW = (  # as ROS's teleop_twist_keyboard: what is typed while it publishes is thrown away
    SELECTING.replace("tty.setcbreak(sys.stdin.fileno(), termios.TCSANOW)", "tty.setraw(0)")
    .replace("termios.TCSANOW, before)", "termios.TCSADRAIN, before)")
    .replace(
        "    if key in FACTORS:", "    if key == '\\x03':\n        break\n    if key in FACTORS:"
    )
    .replace("        publish()\nalong", "    publish()\nalong")
)
IN_CURSES = """
import curses
import lcmtools
from lcmtools import Node
from lcmtools.types.geometry_msgs import Twist

WAYS = {"i": (1, 0), ",": (-1, 0), "j": (0, 1), "l": (0, -1), "u": (1, 1), "o": (1, -1),
        "m": (-1, -1), ".": (-1, 1)}
FACTORS = {"q": (1.1, 1.1), "w": (1.1, 1), "e": (1, 1.1), "z": (0.9, 0.9), "x": (0.9, 1),
           "c": (1, 0.9)}


def drive(screen):
    lcmtools.init()
    publisher = Node("teleop").create_publisher(Twist, "/RosAria/cmd_vel", 1)
    speed, turn, way = 0.5, 1.0, (0, 0)
    screen.timeout(50)
    while lcmtools.ok():
        number = screen.getch()
        if number < 0:
            continue
        key, twist = chr(number), Twist()
        faster, more_turn = FACTORS.get(key, (1, 1))
        speed, turn = speed * faster, turn * more_turn
        way = way if key in FACTORS else WAYS.get(key, (0, 0))
        twist.linear.x, twist.angular.z = way[0] * speed, way[1] * turn
        publisher.publish(twist)
        screen.addstr(0, 0, f"{twist.linear.x:.2f} m/s, {twist.angular.z:.2f} rad/s")
    publisher.publish(Twist())
    lcmtools.shutdown()


curses.wrapper(drive)
"""
SAVES_ONE = """
import sys
import PIL.Image
import lcmtools
from lcmtools import Node
from lcmtools.types.sensor_msgs import Image


def save(image):
    near = [min(255, low // 40 + 256 * high // 40)
            for low, high in zip(image.data[::2], image.data[1::2])]
    picture = PIL.Image.new("L", (image.width, image.height))
    picture.putdata(near)
    picture.save(sys.argv[-1])
    lcmtools.shutdown()


lcmtools.init()
node = Node("viewer")
node.create_subscription(Image, "/camera/depth/image_raw", save, 1)
lcmtools.spin(node)
"""
ARRIVES = """
import math
import lcmtools
from lcmtools import Node
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry, Path


class Follower(Node):
    def __init__(self):
        super().__init__("follower")
        self.points = None
        self.publisher = self.create_publisher(Twist, "/RosAria/cmd_vel", 1)
        self.create_subscription(Path, "/path", self.take, 1)
        self.create_subscription(Odometry, "/ground_truth", self.drive, 1)

    def take(self, path):
        places = [one.pose.position for one in path.poses]
        self.points = self.points or [(one.x, one.y) for one in places]

    def drive(self, truth):
        if self.points is None:
            return
        pose, twist = truth.pose.pose, Twist()
        here = pose.position.x, pose.position.y
        while self.points and math.dist(self.points[0], here) < 0.25:
            self.points.pop(0)
        if self.points:
            (x, y), heading = self.points[0], 2 * math.atan2(pose.orientation.z, pose.orientation.w)
            error = math.remainder(math.atan2(y - here[1], x - here[0]) - heading, math.tau)
            twist.angular.z = max(-1.5, min(1.5, 2.5 * error))
            twist.linear.x = 0.4 * max(0.0, math.cos(error))
        self.publisher.publish(twist)
        if not self.points:
            lcmtools.shutdown()


lcmtools.init()
lcmtools.spin(Follower())
"""


@pytest.mark.parametrize(
    ("option", "source"),
    [
        ("teleop", SELECTING),
        ("teleop", RAW),
        ("teleop", IN_CURSES),
        ("viewer", SAVES_ONE),
        ("path", ARRIVES),
    ],
)
def test_a_program_of_another_style_is_right(option, source, cli, tmp_path):
    script = tmp_path / "program.py"
    script.write_text(source)
    command = shlex.join([sys.executable, str(script)])
    result = cli("lab", "check", "pioneer", f"--{option}", command, "--json")
    assert not [row for row in json.loads(result.out)["rows"] if not row["ok"]]
    assert result.code == 0
