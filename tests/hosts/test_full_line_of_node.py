"""Two nodes on Zenoh, without a relay, on two computers joined by a line that is full."""

import json
import re

import pytest

_URL = "zenoh://?interface=eth0&patience=5"  # a large message takes a second
_MEGABIT = 1e6 / 8  # [byte/s]

# BYTES HZ: a node that publishes images and commands
_ROBOT = """
import sys, lcmtools
from lcmtools.types import geometry_msgs, sensor_msgs
lcmtools.init()
node = lcmtools.Node("robot")
images = node.create_publisher(sensor_msgs.Image, "/camera/image", 10)
commands = node.create_publisher(geometry_msgs.Twist, "/cmd_vel", 10)
size = int(sys.argv[1])
image = sensor_msgs.Image(data_length=size, data=bytes(size))
node.create_timer(1 / float(sys.argv[2]), lambda: images.publish(image))
node.create_timer(0.05, lambda: commands.publish(geometry_msgs.Twist()))
print("sends", flush=True)
lcmtools.spin(node)
"""
# SECONDS: a node that receives them, in callbacks for images that take so long
_OFFICE = """
import sys, time, lcmtools
from lcmtools.types import geometry_msgs, sensor_msgs
lcmtools.init()
node = lcmtools.Node("office")
pause = float(sys.argv[1])
node.create_subscription(sensor_msgs.Image, "/camera/image", lambda _: time.sleep(pause), 1)
node.create_subscription(geometry_msgs.Twist, "/cmd_vel", lambda _: None, 10)
print("listens", flush=True)
lcmtools.spin(node)
"""


class _Nodes:
    """A robot and an office, and a line of so many bytes a second."""

    def __init__(self, network, rate, pause=0.0):
        self.hosts = self.robot, self.office = network.hosts
        network.stretch(self.robot, 10.0, 1_000_000, rate)
        self.office.python(_OFFICE, str(pause), LCM_DEFAULT_URL=_URL).wait_for("listens")

    def publish(self, size, rate):
        """Start the robot's node."""
        node = self.robot.python(_ROBOT, str(size), str(rate), LCM_DEFAULT_URL=_URL)
        node.wait_for("sends")
        return node

    def full_lines(self):
        """Return what ``wtf`` says of a full line on each of the hosts that sees one."""
        words = ("wtf", "--rule", "full-line", "--json")
        shown = [host.lcmtools(*words, LCM_DEFAULT_URL=_URL) for host in self.hosts]
        found = [finding for one in shown for finding in json.loads(one.stdout)]
        return [" ".join((*one["items"], *one["remedies"])) for one in found]


@pytest.mark.parametrize("size", [20_000, 100_000])
def test_wtf_names_a_line_that_a_node_fills_on_both_sides(network, size, wait_until):
    nodes = _Nodes(network("robot", "office"), _MEGABIT)
    robot, texts = nodes.publish(size, 30), []

    def is_named_on_both():
        texts[:] = nodes.full_lines()
        return len(texts) == 2

    wait_until(is_named_on_both)
    for text in texts:
        assert re.search(r"/robot on robot: /camera/image, .* Hz pass to 10\.76\.0\.2 ", text), text
        assert "/cmd_vel" not in text
    limits = [float(one) for text in texts for one in re.findall(r"at ([0-9.]+) Hz at most", text)]
    assert limits, texts
    robot.end()
    nodes.publish(size, min(limits))
    wait_until(lambda: nodes.full_lines() == [])


def test_a_line_that_takes_all_and_a_slow_callback_are_no_full_line(network):
    nodes = _Nodes(network("robot", "office"), 10 * _MEGABIT, pause=0.5)
    nodes.publish(20_000, 30)
    for _ in range(3):
        assert nodes.full_lines() == []
