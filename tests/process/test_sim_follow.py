"""Several processes that simulate one world together: one leads the clock, the others go by it."""

import sys
from dataclasses import dataclass, field

import pytest

import lcmtools as library
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.rosgraph_msgs import Clock

FOLLOWER = "/husky2/ground_truth"


@dataclass
class Heard:
    """Times [ns] in the order in which they came, and where the follower's robot was."""

    clock: list[int] = field(default_factory=list)
    stamps: list[int] = field(default_factory=list)
    ahead: list[int] = field(default_factory=list)
    x: list[float] = field(default_factory=list)

    def hear_clock(self, message):
        """Note the leader's time."""
        self.clock.append(message.clock.sec * 10**9 + message.clock.nsec)

    def hear_robot(self, message):
        """Note the follower's time, and where its robot is."""
        stamp = message.header.stamp.sec * 10**9 + message.header.stamp.nsec
        self.stamps.append(stamp)
        self.x.append(message.pose.pose.position.x)


@pytest.fixture
def node(bus_url):
    library.init([], url=bus_url)
    with library.Node("test") as node:
        yield node
    library.shutdown()


def test_a_follower_steps_as_far_as_the_leader_and_restarts_with_it(
    node, bus_url, start, cli, wait_until, monkeypatch
):
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    heard = Heard()
    node.create_subscription(Clock, "/clock", heard.hear_clock, depth=1000)
    node.create_subscription(Odometry, FOLLOWER, heard.hear_robot, depth=1000)
    drive = node.create_publisher(Twist, "/husky2/cmd_vel")

    def spin(condition):
        def turn():
            library.spin_once(node, 0.05)
            return condition()

        wait_until(turn)

    run = (sys.executable, "-m", "lcmtools_sim", "multi", "--lcm-url", bus_url)
    start(*run, "--only", "husky2").wait_for("waiting for the /clock of the process that leads")
    start(*run, "--only", "husky0,husky1", "--paused")
    spin(lambda: cli("sim", "step", "24", "--sim", "/sim").code == 0)
    spin(lambda: heard.clock and heard.clock[-1] == 10**8)
    cli("sim", "step", "216", "--sim", "/sim")
    spin(lambda: heard.stamps and heard.stamps[-1] == 10**9)
    assert heard.clock[-1] == 10**9

    forward = Twist()
    forward.linear.x = 1.0
    drive.publish(forward)
    cli("sim", "step", "480", "--sim", "/sim")
    spin(lambda: heard.stamps[-1] == 3 * 10**9)
    assert heard.x[-1] > heard.x[0] + 0.5

    assert cli("sim", "reset", "--sim", "/sim").code == 0
    cli("sim", "step", "24", "--sim", "/sim")
    spin(lambda: heard.stamps[-1] == 10**8)
    assert heard.x[-1] == pytest.approx(heard.x[0], abs=1e-3)
