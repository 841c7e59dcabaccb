"""Skeletons pass the check of their lab when their TODOs are filled in, and nothing else."""

import shlex
import sys
from textwrap import dedent, indent

import pytest

REMOVE = "# remove this line"
FILLED = {
    "evaluate_controller": {
        "self.create_publisher(TYPE": """
            self.squares = 0.0
            self.publisher = self.create_publisher(ControllerEvaluationStat, "evaluation_stat")
            """,
        "self.create_subscription(TYPE": """
            self.create_subscription(Odometry, "odometry", self.odometry_callback, 100)
            self.create_subscription(Twist, "desired_velocity", self.desired_velocity_callback, 1)
            """,
        f"del twist  {REMOVE}": "self.desired = twist",
        "self.samples += 1": """
            measured = odometry.twist.twist
            square = (measured.linear.x - self.desired.linear.x) ** 2
            square += (measured.angular.z - self.desired.angular.z) ** 2
            self.squares += square
            self.samples += 1
            """,
        f"del message, odometry  {REMOVE}": """
            message.samples = self.samples
            message.last_error = square**0.5
            message.average_error = (self.squares / self.samples) ** 0.5
            self.publisher.publish(message)
            """,
    },
    "kinect_viewer": {
        "# The 1 keeps only": "self.create_subscription(Image, TOPIC, self.kinect_callback, 1)"
    },
    "listener": {
        "self.create_subscription(TYPE": """
            self.create_subscription(String, "chatter", self.chatter_callback)
            """,
        REMOVE: "self.get_logger().info(message.data)",
    },
    "moving_robot": {
        "self.create_publisher(TYPE": """
            self.publisher = self.create_publisher(Twist, "/dolly/cmd_vel", 10)
            """,
        "self.create_timer(SECONDS": "self.create_timer(0.5, self.timer_callback)",
        REMOVE: """
            message.linear.x, message.angular.z = 0.5, 0.3
            self.publisher.publish(message)
            """,
    },
    "path_follower": {
        REMOVE: """
            x, y = self.points[self.next]
            while math.dist((x, y), (position.x, position.y)) < 0.4:
                if self.next == len(self.points) - 1:
                    break
                self.next += 1
                x, y = self.points[self.next]
            angle = math.atan2(y - position.y, x - position.x) - heading
            if math.dist((x, y), (position.x, position.y)) > 0.1:
                message.linear.x = 0.4
                message.angular.z = 2.0 * math.remainder(angle, math.tau)
            """,
    },
    "pioneer_manual_controller": {
        "# TODO 2: for the keys": """
            ways = {"i": (1, 0), ",": (-1, 0), "j": (0, 1), "l": (0, -1), "u": (1, 1)}
            ways |= {"o": (1, -1), "m": (-1, -1), ".": (-1, 1), "k": (0, 0)}
            self.way = ways.get(keyboard_input, getattr(self, "way", (0, 0)))
            """,
        "# TODO 3: for the keys": """
            factor = {"q": 1.1, "w": 1.1, "e": 1.1, "z": 0.9, "x": 0.9, "c": 0.9}
            if keyboard_input in "qzwx":
                self.speed *= factor[keyboard_input]
            if keyboard_input in "qzec":
                self.turn *= factor[keyboard_input]
            self.cmdvel.linear.x = self.way[0] * self.speed
            self.cmdvel.angular.z = self.way[1] * self.turn
            """,
    },
    "reading_laser": {
        "# called with each message": """
            self.create_subscription(LaserScan, "/dolly/laser_scan", self.scan_callback, 10)
            """,
        REMOVE: """
            ahead = scan.ranges[len(scan.ranges) // 2]
            text = f"ahead {ahead:.2f} m, nearest {min(scan.ranges):.2f} m"
            self.get_logger().info(text, throttle=0.5)
            """,
    },
    "simple_controller": {
        f"del twist  {REMOVE}": "self.desired = twist",
        f"del odometry  {REMOVE}": """
            speed = self.desired.linear.x - odometry.twist.twist.linear.x
            turn = self.desired.angular.z - odometry.twist.twist.angular.z
            self.sums = getattr(self, "sums", (0.0, 0.0))
            self.sums = self.sums[0] + 0.1 * speed, self.sums[1] + 0.05 * turn
            """,
        "left, right = 0.0, 0.0": """
            drive, steer = 0.8 * speed + self.sums[0], 0.4 * turn + self.sums[1]
            left, right = drive - steer, drive + steer
            """,
    },
    "talker": {
        "self.create_publisher(TYPE": 'self.publisher = self.create_publisher(String, "chatter")',
        "self.create_timer(SECONDS": "self.create_timer(0.1, self.timer_callback)",
        REMOVE: """
            message.data = f"hello world {self.count}"
            self.publisher.publish(message)
            """,
    },
}
"""By skeleton: a part of a line at each TODO, and the code that takes the line's place."""

CHECKS = {
    "evaluate_controller": ("husky", "evaluator"),
    "kinect_viewer": ("pioneer", "viewer"),
    "moving_robot": ("dolly", "mover"),
    "path_follower": ("pioneer", "path"),
    "pioneer_manual_controller": ("pioneer", "teleop"),
    "reading_laser": ("dolly", "reader"),
    "simple_controller": ("husky", "controller"),
}


def fill(name, cli, folder):
    """Copy a skeleton and fill it in."""
    path = folder / f"{name}.py"
    assert cli("lab", "skeleton", name, str(folder)).code == 0
    lines = path.read_text().splitlines()
    for part, code in FILLED[name].items():
        (number,) = (number for number, line in enumerate(lines) if part in line)
        lines[number] = indent(dedent(code).strip(), " " * 8)
    path.write_text("\n".join(lines))
    return path


@pytest.mark.usefixtures("quiet_network")
@pytest.mark.parametrize("name", CHECKS)
def test_a_skeleton_passes_its_check_when_only_its_todos_are_filled(name, cli, tmp_path):
    path = fill(name, cli, tmp_path)
    lab, option = CHECKS[name]

    checked = cli("lab", "check", lab, f"--{option}", shlex.join([sys.executable, str(path)]))

    assert checked.code == 0, checked.out


def test_the_talker_is_heard_by_the_listener_when_both_are_filled(
    cli, start, bus_url, tmp_path, monkeypatch
):
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    listener = start(sys.executable, str(fill("listener", cli, tmp_path)))
    start(sys.executable, str(fill("talker", cli, tmp_path)), "__name:=mine")

    assert "[/listener]: hello world " in listener.wait_for("hello world")
    assert cli("node", "list").out == "/listener\n/mine\n"
